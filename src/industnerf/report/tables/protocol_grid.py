"""The grid of protocols: mean EMDs, and which protocols the paper's numbers can come from."""

from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean

from industnerf.errors import BadArtifact
from industnerf.report import paper_results
from industnerf.report.publish.provenance import commit_label, read_provenance
from industnerf.report.tables.formats import (
    csv_text,
    format_fixed,
    format_significant,
    markdown_table,
    read_csv,
)

CELL_KEYS = ("points", "reduction", "surface", "cost", "scale")
FLOOR, DIAGONAL = "floor", "diagonal"
ProtocolCells = Mapping[str, Mapping[str, list[dict]]]  # part id -> subject -> cells
ValuesByPart = dict[str, dict[str, float]]  # part id -> subject -> value
INADMISSIBLE = "no: the floor is above it"


@dataclass(frozen=True)
class GridRow:
    """One protocol: the mean of every subject over the parts that have it."""

    cell: tuple
    means: dict[str, float]
    mm: dict[str, float]  # the same in mm or mm^2; empty where a table has none
    parts: int

    @property
    def is_squared(self) -> bool:
        """Whether the cost is the square of a distance."""
        return "squared" in self.cell

    @property
    def unit(self) -> str:
        """Of `mm`."""
        return "mm^2" if self.is_squared else "mm"

    @property
    def decimals(self) -> int:
        """Of a mean as text."""
        return 6 if self.is_squared else 4

    @property
    def is_admissible(self) -> bool:
        """Whether the paper's number is above the floor."""
        return self.means[FLOOR] <= paper_results.EMD["industnerf"]


def grid_rows(cells: ProtocolCells, diagonals_mm: Mapping[str, float]) -> list[GridRow]:
    """The means over the parts in which every subject has the cell; `diagonals_mm` by part."""
    values = _by_cell(cells)
    return [
        GridRow(
            cell, _means(by_part), _means(_values_in_mm(cell, values, diagonals_mm)), len(by_part)
        )
        for cell, by_part in values.items()
    ]


def _by_cell(cells: ProtocolCells) -> dict[tuple, ValuesByPart]:
    """Cell -> part id -> subject -> value, of parts in which every subject has the cell."""
    values: dict[tuple, ValuesByPart] = defaultdict(lambda: defaultdict(dict))
    subjects = {subject for by_subject in cells.values() for subject in by_subject}
    for part, by_subject in cells.items():
        for subject, subject_cells in sorted(by_subject.items()):
            for cell in subject_cells:
                values[tuple(cell[name] for name in CELL_KEYS)][part][subject] = cell["value"]
    complete = {
        cell: {
            part: part_values
            for part, part_values in by_part.items()
            if set(part_values) == subjects
        }
        for cell, by_part in sorted(values.items())
    }
    return {cell: by_part for cell, by_part in complete.items() if by_part}


def _values_in_mm(
    cell: tuple, values: dict[tuple, ValuesByPart], diagonals_mm: Mapping[str, float]
) -> ValuesByPart:
    """The values of `cell` in mm, or in mm^2 for squared distances; the scale cancels."""
    power = 2 if "squared" in cell else 1
    return {
        part: {
            subject: value * diagonals_mm[part] ** power for subject, value in by_subject.items()
        }
        for part, by_subject in values[(*cell[:-1], DIAGONAL)].items()
    }


def _means(by_part: ValuesByPart) -> dict[str, float]:
    subjects = next(iter(by_part.values()))
    return {
        subject: fmean(by_subject[subject] for by_subject in by_part.values())
        for subject in subjects
    }


def grid_csv(rows: list[GridRow]) -> str:
    """`grid.csv`: a row for every protocol and subject."""
    table_rows = [
        [
            *row.cell,
            subject,
            mean,
            row.parts,
            paper_results.EMD.get(subject),
            int(row.is_admissible),
            row.mm.get(subject),
            row.unit,
        ]
        for row in rows
        for subject, mean in row.means.items()
    ]
    return csv_text(
        [*CELL_KEYS, "subject", "mean", "parts", "paper", "possible", "mean_mm", "unit"], table_rows
    )


def grid_md(rows: list[GridRow]) -> str:
    """`grid.md`: a row for every protocol, and whether the paper's number is possible."""
    return markdown_table(headers(rows), [format_row(row) for row in rows])


@dataclass(frozen=True)
class PublishedGrid:
    """A grid of protocols in a folder, and the study that it is of."""

    rows: list[GridRow]
    commit: str
    date: str
    paper_emd: float = paper_results.EMD["industnerf"]


def load_published_grid(folder: Path) -> PublishedGrid | None:
    """The grid in `folder`; None if there is none. Raises BadArtifact if its files are torn."""
    if not (folder / "grid.csv").exists():
        return None
    rows, provenance = read_grid(folder / "grid.csv"), read_provenance(folder)
    return PublishedGrid(rows, commit_label(provenance), provenance["date"])


def read_grid(path: Path) -> list[GridRow]:
    """What `grid_csv` wrote; raises BadArtifact if that is not it."""
    means: dict[tuple, dict[str, float]] = defaultdict(dict)
    means_mm: dict[tuple, dict[str, float]] = defaultdict(dict)
    parts: dict[tuple, int] = {}
    try:
        for row in read_csv(path):
            cell = (int(row["points"]), *(row[name] for name in CELL_KEYS[1:]))
            means[cell][row["subject"]] = float(row["mean"])
            parts[cell] = int(row["parts"])
            if row.get("mean_mm"):
                means_mm[cell][row["subject"]] = float(row["mean_mm"])
    except (KeyError, ValueError, TypeError) as error:
        message = f"{path} is no table of a grid: {error!r}; `python -m pipeline.grid` writes it"
        raise BadArtifact(message) from None
    return [GridRow(cell, means[cell], means_mm[cell], parts[cell]) for cell in means]


def headers(rows: list[GridRow]) -> list[str]:
    """The heads of the columns of `format_row`."""
    subjects = list(rows[0].means) if rows else []
    mm_headers = [f"{subject}, mm" for subject in (rows[0].mm if rows else ())]
    return [
        *CELL_KEYS,
        *subjects,
        *mm_headers,
        "parts",
        f"{paper_results.EMD['industnerf']} possible",
    ]


def format_row(row: GridRow) -> list[str]:
    """`row` as text, one for each of `headers`."""
    return [
        *map(str, row.cell),
        *(format_fixed(mean, row.decimals) for mean in row.means.values()),
        *(format_mm(mean, row) for mean in row.mm.values()),
        str(row.parts),
        "yes" if row.is_admissible else INADMISSIBLE,
    ]


def format_mm(mean: float | None, row: GridRow) -> str:
    """A mean of `row.mm`; a squared one with its unit."""
    return format_significant(mean) + (" mm²" if row.is_squared and mean is not None else "")
