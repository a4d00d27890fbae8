"""Which results were made where, with what: `origins.md` of a report, from the store."""

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from industnerf import processor
from industnerf.origin import Origin
from industnerf.report.study import StudyFolders
from industnerf.report.tables.costs import stored_results
from industnerf.report.tables.formats import markdown_table
from industnerf.store import Store

# Measured with a GPU: benchmarks/results.md.
OTHER_BYTES = (
    "Results of a GPU, of another architecture or of libraries that are not held to "
    f"{processor.ISA} have other bytes than the published ones: their mean EMD moves by up to 1 %, "
    "that of a part by 16 % (industnerf) and 4 % (industnerf_plus), one standard deviation"
)
COLUMNS = ("stage", "method", "results", "processor", "instructions", "device", "libraries")


@dataclass(frozen=True)
class OriginRow:
    """`count` results of a stage that one kind of machine made with the same libraries."""

    stage: str
    method: str
    count: int
    origin: Origin
    device: str  # cpu or cuda


def read_origins(folders: StudyFolders, methods: list[str]) -> list[OriginRow]:
    """A row for each kind of origin in each stage and method; of results that the store has."""
    store, counts = Store.from_environment(), Counter[tuple]()
    origins: dict[tuple, Origin] = {}
    for result in stored_results(folders, methods):
        origin = store.origin(result.stage, result.key)
        cost = store.cost(result.stage, result.key)
        if origin is None or cost is None:
            continue
        libraries = ", ".join(f"{name} {text}" for name, text in sorted(origin.libraries.items()))
        group = result.stage, result.method, libraries, origin.processor, origin.isa, cost.device
        origins[group] = origin
        counts[group] += 1
    return [
        OriginRow(group[0], group[1], count, origins[group], group[-1])
        for group, count in counts.items()
    ]


def origins_line(rows: Sequence[OriginRow]) -> str:
    """One sentence: the machine and the versions of all results, or what they are a mixture of."""
    machines, versions = Counter[str](), Counter[tuple[str, str]]()
    for row in rows:
        machines[_machine(row)] += row.count
        for library in row.origin.libraries.items():
            versions[library] += row.count
    names = Counter(name for name, _ in versions)
    mixed = [
        f"{count} with {name} {text}"
        for (name, text), count in sorted(versions.items())
        if names[name] > 1
    ]
    if len(machines) > 1:
        mixed = [f"{count} on {name}" for name, count in machines.most_common()] + mixed
    total = sum(machines.values())
    if mixed:
        line = f"The {total} results are a mixture: {', '.join(mixed)}; origins.md has the stages"
    else:
        libraries = ", ".join(f"{name} {text}" for name, text in sorted(versions))
        line = "".join(f"All {total} results were made on {name}, {libraries}" for name in machines)
    other = any(row.device != "cpu" or row.origin.isa != processor.ISA for row in rows)
    return f"{line}. {OTHER_BYTES}" if other else line


def origins_md(rows: Iterable[OriginRow]) -> str:
    """`origins.md`: the sentence, and a table with a row for each of `rows`."""
    rows = list(rows)
    cells = [
        [
            *(row.stage, row.method, str(row.count), row.origin.processor, row.origin.isa),
            row.device,
            ", ".join(f"{name} {text}" for name, text in sorted(row.origin.libraries.items())),
        ]
        for row in rows
    ]
    return f"{origins_line(rows)}.\n\n{markdown_table(COLUMNS, cells)}"


def _machine(row: OriginRow) -> str:
    return f"{row.origin.processor} ({row.origin.isa}{', a GPU' if row.device == 'cuda' else ''})"
