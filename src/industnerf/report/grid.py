"""The grid of protocols: which of them can the paper's numbers have come from?"""

from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass
from html import escape
from pathlib import Path
from statistics import fmean

from industnerf.errors import BadArtifact
from industnerf.report import paper
from industnerf.report.formats import brief, csv_rows, csv_text, markdown, short
from industnerf.report.markup import Column, note, table
from industnerf.report.markup import Line as Row
from industnerf.report.provenance import commit_of, read_made

CELL = ("points", "reduction", "surface", "cost", "scale")
FLOOR, DIAGONAL = "floor", "diagonal"
Cells = Mapping[str, Mapping[str, list[dict]]]  # part id -> subject -> cells
Values = dict[str, dict[str, float]]  # part id -> subject -> value
IMPOSSIBLE = "no: the floor is above it"
ABOUT = (
    "Mean EMD under every protocol that the paper may have meant, over the test parts of the "
    "study of commit {commit}, {date}, whatever else this page shows. <i>points</i> on "
    "either side; <i>reduction</i> of the prediction; <i>cost</i> of moving a point: its distance, "
    "or that squared; <i>scale</i>: the length that is 1, which changes no mean in mm (of squares: "
    "mm²). Where the floor, a second sample of the "
    "true surface, is above the paper's {paper}, no method can have scored that."
)


@dataclass(frozen=True)
class Line:
    """One cell: the mean over the parts that have it, of every subject."""

    cell: tuple
    means: dict[str, float]
    mm: dict[str, float]  # the same, each part in mm or mm^2; empty where a table has none
    parts: int

    @property
    def squared(self) -> bool:
        """Whether the cost is the square of a distance."""
        return "squared" in self.cell

    @property
    def unit(self) -> str:
        """Of `mm`."""
        return "mm^2" if self.squared else "mm"

    @property
    def decimals(self) -> int:
        """With which a mean is told."""
        return 6 if self.squared else 4

    @property
    def possible(self) -> bool:
        """Whether the paper's number is above what a perfect method scores in this cell."""
        return self.means[FLOOR] <= paper.EMD["industnerf"]


def lines(cells: Cells, diagonals_mm: Mapping[str, float]) -> list[Line]:
    """The means over the parts in which every subject has the cell; `diagonals_mm` by part."""
    found = _by_cell(cells)
    return [
        Line(cell, _means(of_parts), _means(_in_mm(cell, found, diagonals_mm)), len(of_parts))
        for cell, of_parts in found.items()
    ]


def _by_cell(cells: Cells) -> dict[tuple, Values]:
    """Cell -> part id -> subject -> value, of parts in which every subject has the cell."""
    values: dict[tuple, Values] = defaultdict(lambda: defaultdict(dict))
    subjects = {subject for of_part in cells.values() for subject in of_part}
    for part, of_part in cells.items():
        for subject, found in sorted(of_part.items()):
            for cell in found:
                values[tuple(cell[name] for name in CELL)][part][subject] = cell["value"]
    whole = {
        cell: {part: of for part, of in of_parts.items() if set(of) == subjects}
        for cell, of_parts in sorted(values.items())
    }
    return {cell: of_parts for cell, of_parts in whole.items() if of_parts}


def _in_mm(cell: tuple, found: dict[tuple, Values], diagonals_mm: Mapping[str, float]) -> Values:
    """The values of `cell`, whose scale is none in mm, or in mm^2 if it is of squares."""
    power = 2 if "squared" in cell else 1
    return {
        part: {subject: value * diagonals_mm[part] ** power for subject, value in of.items()}
        for part, of in found[(*cell[:-1], DIAGONAL)].items()
    }


def _means(of_parts: Values) -> dict[str, float]:
    subjects = next(iter(of_parts.values()))
    return {subject: fmean(of[subject] for of in of_parts.values()) for subject in subjects}


def grid_csv(found: list[Line]) -> str:
    """`grid.csv`: a row for every cell and subject."""
    lines = [
        [
            *line.cell,
            subject,
            mean,
            line.parts,
            paper.EMD.get(subject),
            int(line.possible),
            line.mm.get(subject),
            line.unit,
        ]
        for line in found
        for subject, mean in line.means.items()
    ]
    return csv_text(
        [*CELL, "subject", "mean", "parts", "paper", "possible", "mean_mm", "unit"], lines
    )


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
    in_mm: dict[tuple, dict[str, float]] = defaultdict(dict)
    parts: dict[tuple, int] = {}
    try:
        for row in csv_rows(path):
            cell = (int(row["points"]), *(row[name] for name in CELL[1:]))
            means[cell][row["subject"]] = float(row["mean"])
            parts[cell] = int(row["parts"])
            if row.get("mean_mm"):
                in_mm[cell][row["subject"]] = float(row["mean_mm"])
    except (KeyError, ValueError, TypeError) as error:
        said = f"{path} is no table of a grid: {error!r}; `python -m pipeline.grid` writes it"
        raise BadArtifact(said) from None
    return [Line(cell, means[cell], in_mm[cell], parts[cell]) for cell in means]


def _heads(found: list[Line]) -> list[str]:
    subjects = list(found[0].means) if found else []
    lengths = [f"{subject}, mm" for subject in (found[0].mm if found else ())]
    return [*CELL, *subjects, *lengths, "parts", f"{paper.EMD['industnerf']} possible"]


def _texts(line: Line) -> list[str]:
    return [
        *map(str, line.cell),
        *(short(mean, line.decimals) for mean in line.means.values()),
        *(in_unit(mean, line) for mean in line.mm.values()),
        str(line.parts),
        "yes" if line.possible else IMPOSSIBLE,
    ]


def in_unit(mean: float | None, line: Line) -> str:
    """A mean of `line.mm` under a head that says mm: of squares it has its unit."""
    return brief(mean) + (" mm²" if line.squared and mean is not None else "")
