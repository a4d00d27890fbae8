"""docs/reference/readings.md: effect of the readings of measuring, R12 and R13, on one method.

The images and clouds are the same and the measure differs.  R12 uses the scores of the published
study; R13 uses the grid of protocols, where one choice at a time differs from P1-even.
"""

from collections.abc import Iterator
from pathlib import Path
from statistics import fmean

from industnerf.report import paper_results
from industnerf.report.publish.provenance import commit_label, describe_provenance, read_provenance
from industnerf.report.tables.formats import format_fixed, markdown_table, read_csv
from industnerf.report.tables.protocol_grid import FLOOR, GridRow, format_mm, read_grid
from industnerf.report.tables.table2 import LOSSES

HULL = "hull"
PIXEL_SCOPES = ("P1-union", "P1-frame")
PROTOCOL_VARIANTS = {  # what differs from P1-even: a cell of the grid
    "P1-even": (4096, "even", "visible", "distance", "diagonal"),
    "random points": (4096, "iid", "visible", "distance", "diagonal"),
    "the whole surface": (4096, "even", "full", "distance", "diagonal"),
    "longest edge 1": (4096, "even", "visible", "distance", "longest"),
    "1024 points": (1024, "even", "visible", "distance", "diagonal"),
    "2048 points": (2048, "even", "visible", "distance", "diagonal"),
    "squared": (4096, "even", "visible", "squared", "diagonal"),
    "8192 points": (8192, "even", "visible", "distance", "diagonal"),
}


def protocol_block(study: Path, grid: Path) -> str:
    """The tables of R12 and R13, with their sources; `grid` is the folder of the protocol grid.

    Raises BadArtifact if the grid is torn.
    """
    provenance = read_provenance(grid)
    cells = {row.cell: row for row in read_grid(grid / "grid.csv")}
    protocol_rows = [
        _protocol_row(name, cells[cell])
        for name, cell in PROTOCOL_VARIANTS.items()
        if cell in cells
    ]
    subjects = f"EMD, `{paper_results.METHOD}`", "in mm", "floor", "x floor", f"EMD, `{HULL}`"
    heads = ["id", "reading", *subjects, "parts"]
    scope_heads = ["id", "reading", "loss", f"`{paper_results.METHOD}`", "parts"]
    return (
        f"R12: results/{study.name}/scores.csv, test parts, {describe_provenance(study)}.\n\n"
        f"{markdown_table(scope_heads, _pixel_scope_rows(study))}\n"
        f"R13: results/{grid.name}/grid.csv, test parts, {provenance['date']}, "
        f"commit {commit_label(provenance)}.\n\n"
        f"{markdown_table(heads, protocol_rows)}"
    )


def _pixel_scope_rows(study: Path) -> Iterator[list[str]]:
    """A row for each loss that is measured in both of `PIXEL_SCOPES`, and each of these."""
    rows = [
        row
        for row in read_csv(study / "scores.csv")
        if (row["method"], row["split"]) == (paper_results.METHOD, "test")
    ]
    for loss in LOSSES:
        values = {scope: _metric_values(rows, loss.metric, scope) for scope in PIXEL_SCOPES}
        for scope, scope_values in values.items() if all(values.values()) else ():
            mean = format_fixed(fmean(scope_values), loss.digits)
            yield ["R12", f"`{scope}`", loss.name, mean, str(len(scope_values))]


def _metric_values(rows: list[dict[str, str]], metric: str, protocol: str) -> list[float]:
    metric_key = metric, protocol
    return [float(row["value"]) for row in rows if (row["metric"], row["protocol"]) == metric_key]


def _protocol_row(name: str, row: GridRow) -> list[str]:
    emd, floor, hull = (row.means[subject] for subject in (paper_results.METHOD, FLOOR, HULL))
    emd_text, floor_text, hull_text = (
        format_fixed(mean, row.decimals) for mean in (emd, floor, hull)
    )
    mm = format_mm(row.mm.get(paper_results.METHOD), row)
    return [
        "R13",
        f"`{name}`",
        emd_text,
        mm,
        floor_text,
        format_fixed(emd / floor, 2),
        hull_text,
        str(row.parts),
    ]
