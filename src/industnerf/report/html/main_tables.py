"""Tables 1 and 2 and the table of parts, as they stand on the page."""

from collections.abc import Sequence
from html import escape

from industnerf.artifacts.part import Part
from industnerf.artifacts.scores import Score
from industnerf.methods.base import Role
from industnerf.report.html.markup import (
    Column,
    HtmlRow,
    details_html,
    emphasized,
    html_table,
    note,
    part_link,
)
from industnerf.report.study import Study
from industnerf.report.tables import table2
from industnerf.report.tables.formats import format_fixed, format_significant, label_intervals
from industnerf.report.tables.score_lookup import Scores
from industnerf.report.tables.table1 import Table1Row
from industnerf.report.tables.table1_text import (
    COLUMNS,
    SEEDS_COLUMN,
    Table1Extra,
    describe_training,
    format_row,
    table1_notes,
)

TEXT_COLUMNS = ("method", "inputs", "subset", "loss")
GROUP_TITLES = {
    "dev": "The dev parts, which were tuned on",
    "figure3": "One part of every family, chosen by hash: figure3",
}
COLUMN_ORDER = (  # of Table 1, with the columns that only the page has
    "method",
    "inputs",
    "views",
    "EMD (even)",
    "95 %",
    SEEDS_COLUMN,
    "paper",
    "EMD, mm",
    "floor",
    "x floor",
    "x industnerf",
    "EMD (iid)",
    "EMD (full)",
    "parts",
    "failed",
    "without failures",
    "s a part",
)


def table1_html(rows: Sequence[Table1Row], extras: Sequence[Table1Extra], interval: float) -> str:
    """Table 1 of the reported parts, and folded away that of the dev parts."""
    html_rows = [_table1_row(row, extra) for row, extra in zip(rows, extras, strict=True)]
    tables = _tables_by_group(
        _columns(COLUMN_ORDER, interval), [row.split for row in rows], html_rows
    )
    return tables + training_html(rows) + "".join(note(escape(text)) for text in table1_notes(rows))


def _tables_by_group(columns: list[Column], groups: list[str], rows: list[HtmlRow]) -> str:
    """A table of the lines of the first group, and those of each other group folded away."""
    if not rows:
        return ""
    first, *folded_groups = [
        (
            name,
            html_table(
                columns, [row for group, row in zip(groups, rows, strict=True) if group == name]
            ),
        )
        for name in dict.fromkeys(groups)
    ]
    return first[1] + "".join(
        details_html(GROUP_TITLES.get(name, name), text) for name, text in folded_groups
    )


def _columns(heads: Sequence[str], interval: float) -> list[Column]:
    return [
        Column(label, head in TEXT_COLUMNS)
        for head, label in zip(heads, label_intervals(heads, interval), strict=True)
    ]


def _table1_row(row: Table1Row, extra: Table1Extra) -> HtmlRow:
    texts = dict(zip(COLUMNS, map(escape, format_row(row, extra)), strict=True))
    if row.undertrained:
        texts["method"] += " <small>undertrained</small>"
    if row.failures:
        texts["failed"] = emphasized(texts["failed"])
    else:
        texts["without failures"] = ""  # the same as with them
    return HtmlRow(
        [texts[name] for name in COLUMN_ORDER], "" if extra.role == Role.METHOD else "aside"
    )


def training_html(rows: Sequence[Table1Row]) -> str:
    """What the methods of Table 1 learned from other parts; empty if none did."""
    split = rows[0].split if rows else ""
    items = "".join(
        f"<li><b>{escape(row.method)}</b>: {escape(describe_training(row).replace('**', ''))}"
        for row in rows
        if row.num_train_parts and row.split == split
    )
    return items and details_html("What was learned from other parts", f"<ul>{items}</ul>")


def table2_html(rows: Sequence[table2.Table2Row], interval: float) -> str:
    """Table 2."""
    html_rows = [HtmlRow([escape(text) for text in table2.format_row(row)]) for row in rows]
    columns = _columns(table2.COLUMNS, interval)
    return _tables_by_group(columns, [row.subset for row in rows], html_rows)


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


def part_table_html(study: Study, scores: Scores) -> str:
    """EMD (even) of every part and method, with its floor."""
    parts = sorted(study.parts.values(), key=lambda part: (part.family, part.part_id))
    columns = [*PART_COLUMNS, *(Column(method) for method in study.methods)]
    return html_table(columns, [_part_row(study, scores, part) for part in parts])


def _part_row(study: Study, scores: Scores, part: Part) -> HtmlRow:
    method_scores = [scores.get(part.part_id, method) for method in study.methods]
    floor = next((score.floor for score in method_scores if score), None)
    train_share = study.train_visible_share.get(part.part_id)
    texts = [
        part_link(part.part_id, part.designation),
        escape(part.family),
        study.assignments[part.part_id].split,
        escape(", ".join(part.strata)),
        format_significant(part.diagonal_mm),
        format_percent(part.visible_share),
        format_percent(train_share),
        format_fixed(floor),
        *(format_score(score, part) for score in method_scores),
    ]
    return HtmlRow(texts)


def format_percent(share: float | None) -> str:
    """A share as people read it."""
    return "" if share is None else f"{100 * share:.0f} %"


def format_score(score: Score | None, part: Part) -> str:
    """A normalized value, the same in mm, and whether it is a failure's."""
    if score is None:
        return ""
    text = f"{format_fixed(score.value)} <small>{format_significant(score.value * part.diagonal_mm)} mm</small>"
    return text + ("" if score.status == "ok" else emphasized(" (failed)"))
