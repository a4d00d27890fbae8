"""docs/readings.md: what R12 and R13, which are about measuring, make of the paper's method.

The same pictures and clouds, measured otherwise: R12 by the scores of the published study, R13 by
the grid of protocols, of which one choice at a time is another than in P1-even.
"""

from collections.abc import Iterator
from pathlib import Path
from statistics import fmean

from industnerf.report import paper
from industnerf.report.formats import csv_rows, markdown, short
from industnerf.report.grid import FLOOR, Line, in_unit, read_grid
from industnerf.report.provenance import commit_of, made_where, read_made
from industnerf.report.table2 import LOSSES

HULL = "hull"
SCOPES = ("P1-union", "P1-frame")
CHOICES = {  # what is another than in P1-even: a cell of the grid
    "P1-even": (4096, "even", "visible", "distance", "diagonal"),
    "random points": (4096, "iid", "visible", "distance", "diagonal"),
    "the whole surface": (4096, "even", "full", "distance", "diagonal"),
    "longest edge 1": (4096, "even", "visible", "distance", "longest"),
    "1024 points": (1024, "even", "visible", "distance", "diagonal"),
    "2048 points": (2048, "even", "visible", "distance", "diagonal"),
    "squared": (4096, "even", "visible", "squared", "diagonal"),
    "8192 points": (8192, "even", "visible", "distance", "diagonal"),
}


def measuring_block(study: Path, grid: Path) -> str:
    """Two tables, and of what each is; `grid` is the folder of the grid of protocols.

    Raises BadArtifact if the grid is torn.
    """
    made = read_made(grid)
    cells = {line.cell: line for line in read_grid(grid / "grid.csv")}
    protocols = [_protocol(name, cells[cell]) for name, cell in CHOICES.items() if cell in cells]
    subjects = f"EMD, `{paper.METHOD}`", "in mm", "floor", "x floor", f"EMD, `{HULL}`"
    heads = ["id", "reading", *subjects, "parts"]
    return (
        f"R12: results/{study.name}/scores.csv, test parts, {made_where(study)}.\n\n"
        f"{markdown(['id', 'reading', 'loss', f'`{paper.METHOD}`', 'parts'], _scopes(study))}\n"
        f"R13: results/{grid.name}/grid.csv, test parts, {made['date']}, "
        f"commit {commit_of(made)}.\n\n"
        f"{markdown(heads, protocols)}"
    )


def _scopes(study: Path) -> Iterator[list[str]]:
    """A row for each loss that has a mean over both of SCOPES, and each of these."""
    rows = [
        row
        for row in csv_rows(study / "scores.csv")
        if (row["method"], row["split"]) == (paper.METHOD, "test")
    ]
    for loss in LOSSES:
        values = {scope: _values(rows, loss.metric, scope) for scope in SCOPES}
        for scope, found in values.items() if all(values.values()) else ():
            mean = short(fmean(found), loss.digits)
            yield ["R12", f"`{scope}`", loss.name, mean, str(len(found))]


def _values(rows: list[dict[str, str]], metric: str, protocol: str) -> list[float]:
    wanted = metric, protocol
    return [float(row["value"]) for row in rows if (row["metric"], row["protocol"]) == wanted]


def _protocol(name: str, line: Line) -> list[str]:
    ours, floor, hull = (line.means[subject] for subject in (paper.METHOD, FLOOR, HULL))
    a, b, c = (short(mean, line.decimals) for mean in (ours, floor, hull))
    mm = in_unit(line.mm.get(paper.METHOD), line)
    return ["R13", f"`{name}`", a, mm, b, short(ours / floor, 2), c, str(line.parts)]
