"""docs/results.md: what the published study shows, in sentences with their numbers."""

import shutil
from collections.abc import Iterator
from pathlib import Path

from industnerf.report import paper_results
from industnerf.report.docs.claims import BASELINES, difference_text
from industnerf.report.docs.study_results import mean_seconds, test_rows_by_method
from industnerf.report.tables.costs import seconds_label
from industnerf.report.tables.formats import format_emd, read_csv

PLUS, CARVE, HULL = "industnerf_plus", "carve", "hull"
RETRIEVED = {"retrieval": "part", "retrieval_procedural": "part or procedural solid"}
FIGURES = ("contact_sheet.png", "pareto.png", "strata.png", "sparsification.png")

CsvRow = dict[str, str]


def summary_block(study: Path) -> str:
    """A list of findings; what was not run has none."""
    return "".join(f"- {sentence}\n" for sentence in _findings(study))


def copy_figures(study: Path, target: Path) -> None:
    """Bring the published figures to `target`: pages cannot show what lies outside docs/."""
    for name in FIGURES:
        if (study / name).exists():
            shutil.copyfile(study / name, target / name)


def _findings(study: Path) -> Iterator[str]:
    rows = test_rows_by_method(study)
    seconds = mean_seconds(study)
    comparisons = {
        (row["method"], row["other"]): row for row in read_csv(study / "comparisons.csv")
    }
    for method, name in ((PLUS, "our additions"), (paper_results.METHOD, "the paper's method")):
        if method in rows:
            versus = [
                f"Against {text}: {difference_text(row)} (p {float(row['p_holm']):.2g}, Holm)."
                for other, text in ((CARVE, "space carving"), (HULL, "the visual hull"))
                if (row := comparisons.get((method, other)))
            ]
            own = f"{_score(rows[method])}{_time(study, seconds.get(method))}"
            yield " ".join([f"**`{method}`**, {name}: {own}.", *versus])
    networks = [rows[name] for name in BASELINES if name in rows]
    if networks:
        scores = ", ".join(f"`{row['method']}` {_emd(row)}" for row in networks)
        sentences = [f"EMD {scores}."] + [
            f"Retrieval of the most similar {what} has {_emd(rows[method])}."
            for method, what in RETRIEVED.items()
            if method in rows
        ]
        if marked := [f"`{row['method']}`" for row in networks if row["undertrained"]]:
            sentences.append(f"Undertrained: {', '.join(marked)}.")
        yield " ".join(["**The paper's networks**:", *sentences])
    covered = {row["method"]: row for row in read_csv(study / "inspection.csv")}
    for limit in ("0.5", "1"):
        shares = [
            f"`{method}` {100 * float(row[f'covered_{limit}mm']):.0f} %"
            for method in (PLUS, CARVE, HULL, paper_results.METHOD, "oracle")
            if (row := covered.get(method, {})).get(f"covered_{limit}mm")
        ]
        if shares:
            yield f"**Surface within {limit} mm** of the cloud: {', '.join(shares)}."
    failures = sum(int(row["failures"]) for row in rows.values())
    attempts = sum(int(row["parts"]) for row in rows.values())
    yield f"**Failures**: {failures} of {attempts} clouds, those of bounds and nulls among them."


def _score(row: CsvRow) -> str:
    return (
        f"EMD {_emd(row)}, {float(row['ratio_to_floor']):.2f} floors, {float(row['emd_mm']):.2f} mm"
    )


def _emd(row: CsvRow) -> str:
    return format_emd(row["emd_even"], row["ci_low"], row["ci_high"])


def _time(study: Path, seconds: float | None) -> str:
    label = seconds_label(read_csv(study / "cost.csv"))
    return f", {seconds:.0f} {label} a part" if seconds is not None else ""
