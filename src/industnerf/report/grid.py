"""The grid of protocols: which of them can the paper's numbers have come from?"""

import csv
import io
from collections import defaultdict
from dataclasses import dataclass
from statistics import fmean

from industnerf.report import paper
from industnerf.report.formats import markdown

CELL = ("points", "reduction", "surface", "cost", "scale")
FLOOR = "floor"


@dataclass(frozen=True)
class Line:
    """One cell: the mean over the parts that have it, of every subject."""

    cell: tuple
    means: dict[str, float]
    parts: int

    @property
    def possible(self) -> bool:
        """Whether the paper's number is above what a perfect method scores in this cell."""
        return self.means[FLOOR] <= paper.EMD["industnerf"]


def lines(cells: dict[str, dict[str, list[dict]]]) -> list[Line]:
    """The means of part id -> subject -> cells, over parts in which every subject has the cell."""
    values: dict[tuple, dict[str, dict[str, float]]] = defaultdict(lambda: defaultdict(dict))
    subjects = sorted({subject for of_part in cells.values() for subject in of_part})
    for part, of_part in cells.items():
        for subject, found in of_part.items():
            for cell in found:
                values[tuple(cell[name] for name in CELL)][part][subject] = cell["value"]
    return [
        Line(cell, {s: fmean(of[s] for of in whole) for s in subjects}, len(whole))
        for cell, of_parts in sorted(values.items())
        if (whole := [of for of in of_parts.values() if set(of) == set(subjects)])
    ]


def grid_csv(found: list[Line]) -> str:
    """`grid.csv`: a row for every cell and subject."""
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow([*CELL, "subject", "mean", "parts", "paper", "possible"])
    for line in found:
        for subject, mean in line.means.items():
            printed = paper.EMD.get(subject, "")
            table.writerow(
                [*line.cell, subject, f"{mean:.6f}", line.parts, printed, int(line.possible)]
            )
    return text.getvalue()


def grid_md(found: list[Line]) -> str:
    """`grid.md`: a row for every cell, and whether the paper's number is possible in it."""
    subjects = list(found[0].means) if found else []
    heads = [*CELL, *subjects, "parts", f"{paper.EMD['industnerf']} possible"]
    rows = [
        [
            *map(str, line.cell),
            *(f"{line.means[subject]:.4f}" for subject in subjects),
            str(line.parts),
            "yes" if line.possible else "no: the floor is above it",
        ]
        for line in found
    ]
    return markdown(heads, rows)
