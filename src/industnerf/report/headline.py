"""Tables 1 and 2 and the table of parts, as they stand on the page."""

from collections.abc import Sequence
from html import escape

from industnerf.artifacts.part import Part
from industnerf.artifacts.scores import Score
from industnerf.methods.base import Role
from industnerf.report import table2
from industnerf.report.formats import brief, intervals_of, short
from industnerf.report.gather import Study
from industnerf.report.lookup import Scores
from industnerf.report.markup import Column, Line, folded, note, part_link, table, warning
from industnerf.report.table1 import Row
from industnerf.report.table1_text import COLUMNS, SEEDS, Extra, cells, lesson, notes

TEXT = ("method", "inputs", "subset", "loss")
GROUPS = {
    "dev": "The dev parts, which were tuned on",
    "figure3": "One part of every family, chosen by hash: figure3",
}
ORDER = (  # of Table 1, with the columns that only the page has
    "method",
    "inputs",
    "views",
    "EMD (even)",
    "95 %",
    SEEDS,
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


def table1(rows: Sequence[Row], extras: Sequence[Extra], interval: float) -> str:
    """Table 1 of the reported parts, and folded away that of the dev parts."""
    lines = [_line1(row, extra) for row, extra in zip(rows, extras, strict=True)]
    shown = _folded(_columns(ORDER, interval), [row.split for row in rows], lines)
    return shown + lessons(rows) + "".join(note(escape(text)) for text in notes(rows))


def _folded(columns: list[Column], groups: list[str], lines: list[Line]) -> str:
    """A table of the lines of the first group, and those of each other group folded away."""
    if not lines:
        return ""
    first, *others = [
        (name, table(columns, [line for at, line in zip(groups, lines, strict=True) if at == name]))
        for name in dict.fromkeys(groups)
    ]
    return first[1] + "".join(folded(GROUPS.get(name, name), text) for name, text in others)


def _columns(heads: Sequence[str], interval: float) -> list[Column]:
    return [
        Column(shown, head in TEXT)
        for head, shown in zip(heads, intervals_of(heads, interval), strict=True)
    ]


def _line1(row: Row, extra: Extra) -> Line:
    texts = dict(zip(COLUMNS, map(escape, cells(row, extra)), strict=True))
    if row.undertrained:
        texts["method"] += " <small>undertrained</small>"
    if row.failures:
        texts["failed"] = warning(texts["failed"])
    else:
        texts["without failures"] = ""  # the same as with them
    return Line([texts[name] for name in ORDER], "" if extra.role == Role.METHOD else "aside")


def lessons(rows: Sequence[Row]) -> str:
    """What the methods of Table 1 learned from other parts; empty if none did."""
    split = rows[0].split if rows else ""
    items = "".join(
        f"<li><b>{escape(row.method)}</b>: {escape(lesson(row).replace('**', ''))}"
        for row in rows
        if row.learned_from and row.split == split
    )
    return items and folded("What was learned from other parts", f"<ul>{items}</ul>")


def table2_html(lines: Sequence[table2.Line], interval: float) -> str:
    """Table 2."""
    shown = [Line([escape(text) for text in table2.cells(line)]) for line in lines]
    columns = _columns(table2.COLUMNS, interval)
    return _folded(columns, [line.subset for line in lines], shown)


PART_COLUMNS = (
    Column("part", True),
    Column("family", True),
    Column("split", True),
    Column("strata", True, "formulas on the mesh: docs/dataset.md"),
    Column("diagonal, mm"),
    Column("visible", about="share of the surface that can be seen from anywhere around the part"),
    Column("seen", about="share of the surface that its training views show"),
    Column("floor", about="EMD (even) between two samples of the true surface"),
)


def by_part(study: Study, scores: Scores) -> str:
    """EMD (even) of every part and method, with its floor."""
    parts = sorted(study.parts.values(), key=lambda part: (part.family, part.part_id))
    columns = [*PART_COLUMNS, *(Column(method) for method in study.methods)]
    return table(columns, [_part_line(study, scores, part) for part in parts])


def _part_line(study: Study, scores: Scores, part: Part) -> Line:
    found = [scores.get(part.part_id, method) for method in study.methods]
    floor = next((score.floor for score in found if score), None)
    seen = study.seen_by_training.get(part.part_id)
    texts = [
        part_link(part.part_id, part.designation),
        escape(part.family),
        study.places[part.part_id].split,
        escape(", ".join(part.strata)),
        brief(part.diagonal_mm),
        percent(part.visible_share),
        percent(seen),
        short(floor),
        *(value_text(score, part) for score in found),
    ]
    return Line(texts)


def percent(share: float | None) -> str:
    """A share as people read it."""
    return "" if share is None else f"{100 * share:.0f} %"


def value_text(score: Score | None, part: Part) -> str:
    """A normalised value, the same in mm, and whether it is a failure's."""
    if score is None:
        return ""
    text = f"{short(score.value)} <small>{brief(score.value * part.diagonal_mm)} mm</small>"
    return text + ("" if score.status == "ok" else warning(" (failed)"))
