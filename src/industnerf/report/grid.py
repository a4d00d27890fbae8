"""The grid of protocols: which of them can the paper's numbers have come from?"""

from collections import defaultdict
from dataclasses import dataclass
from html import escape
from pathlib import Path
from statistics import fmean

from industnerf.errors import BadArtifact
from industnerf.report import paper
from industnerf.report.formats import csv_rows, csv_text, markdown, short
from industnerf.report.markup import Column, note, table
from industnerf.report.markup import Line as Row
from industnerf.report.provenance import commit_of, read_made

CELL = ("points", "reduction", "surface", "cost", "scale")
FLOOR = "floor"
IMPOSSIBLE = "no: the floor is above it"
ABOUT = (
    "Mean EMD under every protocol that the paper may have meant, over the test parts of the "
    "study of commit {commit}, {date}, whatever else this page shows. <i>points</i> on "
    "either side; <i>reduction</i> of the prediction; <i>cost</i> of moving a point: its distance, "
    "or that squared; <i>scale</i>: the length that is 1. Where the floor, a second sample of the "
    "true surface, is above the paper's {paper}, no method can have scored that."
)


@dataclass(frozen=True)
class Line:
    """One cell: the mean over the parts that have it, of every subject."""

    cell: tuple
    means: dict[str, float]
    parts: int

    @property
    def decimals(self) -> int:
        """With which a mean is told."""
        return 6 if "squared" in self.cell else 4

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
    lines = [
        [*line.cell, subject, mean, line.parts, paper.EMD.get(subject), int(line.possible)]
        for line in found
        for subject, mean in line.means.items()
    ]
    return csv_text([*CELL, "subject", "mean", "parts", "paper", "possible"], lines)


def grid_md(found: list[Line]) -> str:
    """`grid.md`: a row for every cell, and whether the paper's number is possible in it."""
    return markdown(_heads(found), [_texts(line) for line in found])


def grid_html(folder: Path) -> str:
    """What `folder` holds of a grid, as a section of the page; empty if there is none.

    Raises BadArtifact if its files are torn.
    """
    if not (folder / "grid.csv").exists():
        return ""
    found, made = read_grid(folder / "grid.csv"), read_made(folder)
    columns = [Column(head, head in CELL[1:]) for head in _heads(found)]
    facts = {"commit": commit_of(made), "date": made["date"], "paper": paper.EMD["industnerf"]}
    return table(columns, [Row([*map(escape, _texts(line))]) for line in found]) + note(
        ABOUT.format(**facts)
    )


def read_grid(path: Path) -> list[Line]:
    """What `grid_csv` wrote; raises BadArtifact if that is not it."""
    means: dict[tuple, dict[str, float]] = defaultdict(dict)
    parts: dict[tuple, int] = {}
    try:
        for row in csv_rows(path):
            cell = (int(row["points"]), *(row[name] for name in CELL[1:]))
            means[cell][row["subject"]] = float(row["mean"])
            parts[cell] = int(row["parts"])
    except (KeyError, ValueError, TypeError) as error:
        said = f"{path} is no table of a grid: {error!r}; `python -m pipeline.grid` writes it"
        raise BadArtifact(said) from None
    return [Line(cell, means[cell], parts[cell]) for cell in means]


def _heads(found: list[Line]) -> list[str]:
    subjects = list(found[0].means) if found else []
    return [*CELL, *subjects, "parts", f"{paper.EMD['industnerf']} possible"]


def _texts(line: Line) -> list[str]:
    return [
        *map(str, line.cell),
        *(short(mean, line.decimals) for mean in line.means.values()),
        str(line.parts),
        "yes" if line.possible else IMPOSSIBLE,
    ]
