"""Cost of every result and every method, from the side-cars of the store; unknown without it.

The split, a fraction of a second, and a pretraining are not counted; the report counts itself.
"""

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean

from industnerf.artifacts.files import write_text
from industnerf.report.study import Study, StudyFolders
from industnerf.report.tables.formats import csv_text, format_fixed, markdown_table
from industnerf.report.tables.scores import EMD_EVEN, scores_of, select_scores
from industnerf.stage import read_index
from industnerf.store import Cost, Store

Point = tuple[float, float]  # seconds, and EMD (even) over its floor


@dataclass(frozen=True)
class CostRow:
    """Cost of one part in one stage; `method` is empty in stages that are not per method."""

    stage: str
    method: str
    part_id: str
    cost: Cost


@dataclass(frozen=True)
class StoredResult:
    """One result of a study, by its key in the store; `method` as in CostRow."""

    stage: str
    method: str
    part_id: str
    key: str


def stored_results(folders: StudyFolders, methods: list[str]) -> Iterator[StoredResult]:
    """All results that the study consists of."""
    for name in ("solids", "parts", "views", "truth", "procedural"):
        yield from _results(name, "", getattr(folders, name))
    for method in methods:
        if (folders.states / method).exists():  # it learns from other parts
            yield from _results("train", method, folders.states / method)
        yield from _results("reconstruct", method, folders.clouds / method)
        yield from _results("evaluate", method, folders.scores / method)


def _results(stage: str, method: str, folder: Path) -> Iterator[StoredResult]:
    return (StoredResult(stage, method, *item) for item in read_index(folder).items())


def read_costs(folders: StudyFolders, methods: list[str]) -> list[CostRow]:
    """All costs that the store knows."""
    store = Store.from_environment()
    return [
        CostRow(result.stage, result.method, result.part_id, cost)
        for result in stored_results(folders, methods)
        if (cost := store.cost(result.stage, result.key))
    ]


def costs_csv(rows: list[CostRow]) -> str:
    """`cost.csv`: stage, method, part_id and the fields of Cost."""
    return csv_text(
        ["stage", "method", "part_id", *Cost.__dataclass_fields__], map(_row_cells, rows)
    )


def add_cost(path: Path, row: CostRow) -> None:
    """Append `row`, the cost of the report itself, to the cost.csv at `path`."""
    write_text(path, path.read_text(encoding="utf-8") + csv_text(_row_cells(row), []))


def _row_cells(row: CostRow) -> list[str]:
    cells = (row.stage, row.method, row.part_id, *vars(row.cost).values())
    return ["" if cell is None else str(cell) for cell in cells]


def csv_seconds(row: Mapping[str, str], prefix: str = "") -> float:
    """Processor seconds of a row of cost.csv; of an older file, which lacks them, wall seconds.

    With the `prefix` "extra_" those of the held-out views.
    """
    return float(row.get(f"{prefix}cpu_seconds") or row[f"{prefix}seconds"])


def seconds_label(rows: Iterable[Mapping[str, str]]) -> str:
    """What `csv_seconds` of the `rows` are: processor seconds, or wall seconds."""
    has_all = all(row.get("cpu_seconds") for row in rows)
    return "processor seconds" if has_all else "wall seconds"


def seconds_per_part(rows: Sequence[CostRow], method: str, parts: Collection[str]) -> float | None:
    """Mean processor seconds of a reconstruction of `parts`; None if the store knows none."""
    seconds = [
        row.cost.processor_seconds
        for row in rows
        if (row.stage, row.method) == ("reconstruct", method) and row.part_id in parts
    ]
    return fmean(seconds) if seconds else None


def seconds_and_ratios(
    study: Study, costs: Sequence[CostRow], split: str
) -> dict[str, list[Point]]:
    """Method -> seconds and EMD (even) over its floor of each part of `split` with both."""
    seconds = {
        (row.method, row.part_id): row.cost.processor_seconds
        for row in costs
        if row.stage == "reconstruct"
    }
    return {
        method: [
            (seconds[method, row.part_id], row.score.value / row.score.floor)
            for row in select_scores(scores_of(study, method, split), *EMD_EVEN)
            if seconds.get((method, row.part_id))
        ]
        for method in study.methods
    }


CPU_TIME_NOTE = "Times are processor seconds: user and system time of all threads."
WALL_TIME_NOTE = "Times are by the clock: the results are older than the record of processor time."
COLUMNS = (
    *("method", "s a part", "renderings, s", "peak MB", "networks", "minutes a network"),
    *("peak MB of training", "parameters", "steps", "scoring, s a part"),
)


@dataclass(frozen=True)
class MethodCost:
    """One method: means over parts or networks, the maximum of memory; None where unknown.

    Seconds and minutes are of the processor, or by the clock where `is_wall_time`.
    """

    method: str
    seconds: float | None
    extra_seconds: float | None  # renderings of the held-out views
    peak_mb: float | None
    networks: int
    network_minutes: float | None
    network_peak_mb: float | None
    num_parameters: int  # learned
    steps: int
    scoring_seconds: float | None
    is_wall_time: bool  # the results are older than the record of processor time


def method_costs(study: Study, costs: Sequence[CostRow]) -> list[MethodCost]:
    """A row per method, the fastest first, unknown costs last."""
    rows = [_method_cost(study, name, costs) for name in study.methods]
    return sorted(rows, key=lambda row: (row.seconds is None, row.seconds))


def _method_cost(study: Study, method: str, costs: Sequence[CostRow]) -> MethodCost:
    reconstruct_costs, train_costs, evaluate_costs = (
        [row.cost for row in costs if (row.stage, row.method) == (stage, method)]
        for stage in ("reconstruct", "train", "evaluate")
    )
    num_parameters, steps = study.parameters_and_steps[method]
    return MethodCost(
        method,
        _mean([cost.processor_seconds for cost in reconstruct_costs]),
        _mean([cost.extra_processor_seconds for cost in reconstruct_costs]),
        max((cost.peak_mb for cost in reconstruct_costs), default=None),
        len(train_costs),
        _mean([cost.processor_seconds / 60 for cost in train_costs]),
        max((cost.peak_mb for cost in train_costs), default=None),
        num_parameters,
        steps,
        _mean([cost.processor_seconds for cost in evaluate_costs]),
        any(
            cost.cpu_seconds is None for cost in (*reconstruct_costs, *train_costs, *evaluate_costs)
        ),
    )


def _mean(values: list[float]) -> float | None:
    return fmean(values) if values else None


def format_row(row: MethodCost) -> list[str]:
    """`row` as text, one for each of COLUMNS."""
    return [
        row.method,
        format_fixed(row.seconds, 2),
        format_fixed(row.extra_seconds, 2),
        format_fixed(row.peak_mb, 0),
        str(row.networks or ""),
        format_fixed(row.network_minutes, 1),
        format_fixed(row.network_peak_mb, 0),
        str(row.num_parameters or ""),
        str(row.steps or ""),
        format_fixed(row.scoring_seconds, 2),
    ]


def cost_table_md(rows: Sequence[MethodCost]) -> str:
    """`cost.md`: the means of cost.csv."""
    note = WALL_TIME_NOTE if any(row.is_wall_time for row in rows) else CPU_TIME_NOTE
    return f"{markdown_table(COLUMNS, map(format_row, rows))}\n{note}\n"
