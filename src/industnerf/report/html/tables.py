"""The tables of the page: what stands in each cell; templates/macros.html.j2 writes them."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from industnerf.artifacts.part import Part
from industnerf.artifacts.scores import Score
from industnerf.methods.base import Role
from industnerf.report.results import Results
from industnerf.report.statistics import comparisons
from industnerf.report.study import Study
from industnerf.report.tables import (
    costs,
    goals,
    inspection,
    protocol_grid,
    strata,
    table1,
    table1_format,
    table2,
)
from industnerf.report.tables.formats import format_fixed, format_significant, label_intervals
from industnerf.report.tables.scores import Scores

TEXT_COLUMNS = ("method", "inputs", "subset", "loss")
GROUP_TITLES = {
    "dev": "The dev parts, which were tuned on",
    "figure3": "One part of every family, chosen by hash: figure3",
}
TABLE1_COLUMNS = (  # the order on the page
    *(
        "method",
        "inputs",
        "views",
        "EMD (even)",
        "95 %",
        table1_format.SEEDS_COLUMN,
        "paper",
        "EMD, mm",
    ),
    *("floor", "floor, se", "x floor", "x industnerf", "EMD (iid)", "EMD (full)", "parts"),
    *("failed", "without failures", "s a part"),
)


@dataclass(frozen=True)
class Column:
    """One column of a table."""

    header: str
    is_text: bool = False  # set flush left and sorted by name; else numbers
    tooltip: str = ""  # shown when the pointer rests on the heading


@dataclass(frozen=True)
class Cell:
    """More than a plain text: what stands behind it, and where it leads."""

    text: str
    detail: str = ""  # in small print
    alert: str = ""  # must not be overlooked
    part_id: str = ""  # the part whose section `text` links to


@dataclass(frozen=True)
class HtmlRow:
    """One row: a cell for each column."""

    cells: list[str | Cell]
    css_class: str = ""  # failed or aside, or nothing


@dataclass(frozen=True)
class HtmlTable:
    """A table as the page shows it."""

    columns: list[Column]
    rows: list[HtmlRow]


def html_table(columns: Sequence[Column], rows: Sequence[HtmlRow]) -> HtmlTable:
    """The table without the columns that no row fills."""
    filled = [i for i in range(len(columns)) if any(row.cells[i] for row in rows)]
    return HtmlTable(
        [columns[i] for i in filled],
        [HtmlRow([row.cells[i] for i in filled], row.css_class) for row in rows],
    )


def page_tables(
    results: Results, scores: Scores, grid: protocol_grid.PublishedGrid | None
) -> dict[str, HtmlTable | list[tuple[str, HtmlTable]] | None]:
    """Every table of the page, by the name of its section; None where there is nothing to show."""
    interval = results.interval
    return {
        "table1": _table1(results),
        "table2": _grouped(
            _columns(table2.COLUMNS, interval),
            [row.subset for row in results.table2],
            [HtmlRow([*table2.format_row(row)]) for row in results.table2],
        ),
        "inspection": _plain_table(
            inspection.headers(results.inspection), map(inspection.format_row, results.inspection)
        ),
        "comparisons": comparisons_table(results.comparisons, interval),
        "strata": strata_table(results.strata),
        "cost": _plain_table(costs.COLUMNS, map(costs.format_row, results.costs)),
        "goals": _goals(results.goals),
        "grid": grid and grid_table(grid.rows),
        "parts": _parts(results.study, scores),
    }


def _columns(headers: Sequence[str], interval: float) -> list[Column]:
    return [
        Column(label, header in TEXT_COLUMNS)
        for header, label in zip(headers, label_intervals(headers, interval), strict=True)
    ]


def _plain_table(headers: Sequence[str], rows: Iterable[Sequence[str]]) -> HtmlTable | None:
    """Names of methods, and numbers."""
    html_rows = [HtmlRow([*row]) for row in rows]
    return html_table(_columns(headers, 0.95), html_rows) if html_rows else None


def _grouped(
    columns: list[Column], groups: Sequence[str], rows: Sequence[HtmlRow]
) -> list[tuple[str, HtmlTable]]:
    """A title and a table for every group of rows, in the order of their first rows."""
    return [
        (
            GROUP_TITLES.get(name, name),
            html_table(columns, [row for row, g in zip(rows, groups, strict=True) if g == name]),
        )
        for name in dict.fromkeys(groups)
    ]


def _table1(results: Results) -> list[tuple[str, HtmlTable]]:
    """Table 1 of the test parts, and that of the dev parts."""
    pairs = zip(results.table1, results.table1_extras, strict=True)
    return _grouped(
        _columns(TABLE1_COLUMNS, results.interval),
        [row.split for row in results.table1],
        [_table1_row(row, extra) for row, extra in pairs],
    )


def _table1_row(row: table1.Table1Row, extra: table1_format.Table1Extra) -> HtmlRow:
    cells: dict[str, str | Cell] = dict(
        zip(table1_format.COLUMNS, table1_format.format_row(row, extra), strict=True)
    )
    if row.undertrained:
        cells["method"] = Cell(row.method, detail="undertrained")
    if row.failures:
        cells["failed"] = Cell("", alert=str(row.failures))
    else:
        cells["without failures"] = ""  # the same as with them
    css_class = "" if extra.role == Role.METHOD else "aside"
    return HtmlRow([cells[name] for name in TABLE1_COLUMNS], css_class)


def trained_methods(rows: Sequence[table1.Table1Row]) -> list[tuple[str, str]]:
    """Method and training of every method of Table 1 that learned from other parts."""
    return [
        (row.method, table1_format.describe_training(row).replace("**", ""))
        for row in rows
        if row.num_train_parts and row.split == rows[0].split
    ]


def comparisons_table(rows: Sequence[comparisons.Comparison], interval: float) -> HtmlTable | None:
    """A row for every pair of methods that is compared."""
    if not rows:
        return None
    headers = label_intervals(comparisons.COLUMNS, interval)
    columns = [Column(name, name in ("method", "against", "parts")) for name in headers]
    return html_table(columns, [HtmlRow([*comparisons.format_row(row)]) for row in rows])


def strata_table(rows: Sequence[strata.StratumRow]) -> HtmlTable | None:
    """A row for every method, a column for every stratum; None without a test part."""
    if not rows:
        return None
    sizes = {row.stratum: row.parts for row in rows}
    means = {(row.method, row.stratum): row for row in rows}
    columns = [Column("method", True)]
    columns += [Column(f"{name} ({parts})") for name, parts in sizes.items()]
    html_rows = [
        HtmlRow([row.method, *(_stratum_cell(means.get((row.method, name))) for name in sizes)])
        for row in rows
        if row.stratum == strata.ALL
    ]
    return html_table(columns, html_rows)


def _stratum_cell(row: strata.StratumRow | None) -> str | Cell:
    if row is None:  # none of its parts could be scored
        return ""
    return Cell(f"{row.emd_even:.4f}", f"{format_significant(row.emd_mm)} mm")


def _goals(rows: Sequence[goals.Goal]) -> HtmlTable | None:
    """A row for every goal; None if the study has none of the methods."""
    if not rows:
        return None
    numbers = ("measured", "also", *goals.REFERENCE_METHODS)
    columns = [Column(name, name not in numbers) for name in goals.COLUMNS]
    met = goals.COLUMNS.index("met")
    html_rows = []
    for goal in rows:
        cells: list[str | Cell] = [*goals.format_row(goal)]
        cells[met] = "yes" if goal.is_met else Cell("", alert="no")
        html_rows.append(HtmlRow(cells))
    return html_table(columns, html_rows)


def grid_table(rows: list[protocol_grid.GridRow]) -> HtmlTable:
    """A row for every protocol of the grid."""
    columns = [
        Column(name, name in protocol_grid.CELL_KEYS[1:]) for name in protocol_grid.headers(rows)
    ]
    return html_table(columns, [HtmlRow([*protocol_grid.format_row(row)]) for row in rows])


PART_COLUMNS = (
    Column("part", True),
    Column("family", True),
    Column("split", True),
    Column("strata", True, "formulas on the mesh: docs/reference/dataset.md"),
    Column("diagonal, mm"),
    Column(
        "visible", tooltip="share of the surface that can be seen from anywhere around the part"
    ),
    Column("seen", tooltip="share of the surface that its training views show"),
    Column("floor", tooltip="EMD (even) between two samples of the true surface"),
)


def _parts(study: Study, scores: Scores) -> HtmlTable:
    """EMD (even) of every part and method, with its floor."""
    parts = sorted(study.parts.values(), key=lambda part: (part.family, part.part_id))
    columns = [*PART_COLUMNS, *(Column(method) for method in study.methods)]
    return html_table(columns, [_part_row(study, scores, part) for part in parts])


def _part_row(study: Study, scores: Scores, part: Part) -> HtmlRow:
    method_scores = [scores.get(part.part_id, method) for method in study.methods]
    floor = next((score.floor for score in method_scores if score), None)
    cells: list[str | Cell] = [
        Cell(part.designation, part_id=part.part_id),
        part.family,
        study.assignments[part.part_id].split,
        ", ".join(part.strata),
        format_significant(part.diagonal_mm),
        format_percent(part.visible_share),
        format_percent(study.train_visible_share.get(part.part_id)),
        format_fixed(floor),
        *(_score_cell(score, part) for score in method_scores),
    ]
    return HtmlRow(cells)


def format_percent(share: float | None) -> str:
    """A share in percent, or nothing."""
    return "" if share is None else f"{100 * share:.0f} %"


def _score_cell(score: Score | None, part: Part) -> str | Cell:
    """A normalized value, the same in mm, and whether the part failed."""
    if score is None:
        return ""
    return Cell(
        format_fixed(score.value),
        f"{format_significant(score.value * part.diagonal_mm)} mm",
        "" if score.status == "ok" else " (failed)",
    )
