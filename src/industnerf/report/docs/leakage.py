"""docs/baselines.md: what nets owe to parts like those they are asked about, from its sweep."""

from collections.abc import Sequence
from pathlib import Path

from industnerf.errors import BadArtifact
from industnerf.report.docs.readme_tables import table1_cells
from industnerf.report.tables.formats import markdown_table, read_csv

CsvRow = dict[str, str]
HOLD_OUT_HEADERS = {"family": "families held out", "part": "families seen", "none": "parts seen"}
SAME_EMD_TOLERANCE = 1e-5  # the last digit of sweep.csv: so near, the study has measured the same


def leakage_block(sweep: Path, study: Path) -> str:
    """A row a method, the floor first; what the published study has measured too, as it says it.

    Raises BadArtifact as `measured` does.
    """
    results = read_leakage_sweep(sweep)
    rows = list(results.values())
    study_values = _study_values(study, results)
    heads = [head for hold_out in HOLD_OUT_HEADERS.values() for head in (hold_out, "x floor")]
    heads.insert(1, "mm")
    floors = [cell for hold_out in HOLD_OUT_HEADERS for cell in (_mean_floor(rows, hold_out), "1")]
    table_rows = [["floor", floors[0], "", *floors[1:]]]
    for method in dict.fromkeys(row["method"] for row in rows):
        first, ratio, *others = [
            cell
            for hold_out in HOLD_OUT_HEADERS
            for cell in _format_cells(results[method, hold_out])
        ]
        table_rows.append([f"`{method}`", first, *study_values.get(method, ("", ratio)), *others])
    return markdown_table(["method", *heads], table_rows)


def read_leakage_sweep(sweep: Path) -> dict[tuple[str, str], CsvRow]:
    """The rows of the test parts by method and what was held out.

    Raises BadArtifact if a method was not measured at every point.
    """
    rows = [row for row in read_csv(sweep / "sweep.csv") if row["split"] == "test"]
    results = {(row["method"], row["split.hold_out"]): row for row in rows}
    for method, _ in results:
        for hold_out in HOLD_OUT_HEADERS:
            if (method, hold_out) not in results:
                raise BadArtifact(
                    f"{sweep / 'sweep.csv'} has no {method} at split.hold_out {hold_out}: bring in a "
                    "sweep with the same methods at every point, or leave the one before"
                )
    return results


def _format_cells(row: CsvRow) -> tuple[str, str]:
    emd, low, high = (float(row[name]) for name in ("emd", "low", "high"))
    return f"{emd:.4f} ({low:.4f} to {high:.4f})", f"{float(row['x floor']):.2f}"


def _mean_floor(rows: Sequence[CsvRow], hold_out: str) -> str:
    """Of the truth alone: the same for every method."""
    ratios = [
        float(r["emd"]) / float(r["x floor"]) for r in rows if r["split.hold_out"] == hold_out
    ]
    return f"{sum(ratios) / len(ratios):.4f}"


def _study_values(
    study: Path, results: dict[tuple[str, str], CsvRow]
) -> dict[str, tuple[str, str]]:
    """The mm and x floor of each method whose EMD the study and the sweep agree on."""
    cells_by_method = table1_cells(study)
    return {
        row["method"]: (
            cells_by_method[row["method"]]["EMD, mm"],
            cells_by_method[row["method"]]["x floor"],
        )
        for row in read_csv(study / "table1.csv")
        if row["split"] == "test"
        and (sweep_row := results.get((row["method"], "family")))
        and abs(float(row["emd_even"]) - float(sweep_row["emd"])) < SAME_EMD_TOLERANCE
    }
