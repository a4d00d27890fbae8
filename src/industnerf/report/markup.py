"""The few pieces of HTML that the page is made of."""

import base64
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from urllib.parse import quote


@dataclass(frozen=True)
class Column:
    """One column of a table."""

    head: str
    text: bool = False  # words, set flush left and sorted by name; else numbers
    about: str = ""  # shown when the pointer rests on the heading


@dataclass(frozen=True)
class Line:
    """One row: a cell for each column, as HTML."""

    cells: list[str]
    kind: str = ""  # failed or aside, or nothing


def table(columns: Sequence[Column], lines: Sequence[Line]) -> str:
    """A table that sorts by a click on a heading, without the columns that no line fills."""
    filled = [i for i in range(len(columns)) if any(line.cells[i] for line in lines)]
    kinds = [" class=text" if columns[i].text else "" for i in filled]
    head = "".join(
        f"<th{kind} scope=col aria-sort=none{_title(columns[i].about)}>"
        f"<button>{escape(columns[i].head)}</button>"
        for i, kind in zip(filled, kinds, strict=True)
    )
    body = "".join(
        f"<tr{f' class={line.kind}' if line.kind else ''}>"
        + "".join(f"<td{kind}>{line.cells[i]}" for i, kind in zip(filled, kinds, strict=True))
        for line in lines
    )
    return f"<div class=wide><table><thead><tr>{head}</thead><tbody>{body}</tbody></table></div>"


def part_link(part_id: str, text: str) -> str:
    """A link to the section of a part."""
    return f"<a href='{part_address(part_id)}'>{escape(text)}</a>"


def part_address(part_id: str) -> str:
    """The section of a part, as a link names it."""
    return "#" + quote(part_anchor(part_id), safe="=")


def part_anchor(part_id: str) -> str:
    """What the section of a part is called within the page."""
    return f"part={part_id}"


def folded(title: str, text: str) -> str:
    """`text`, HTML, behind a title that opens it."""
    return f"<details><summary>{escape(title)}</summary>{text}</details>"


def warning(text: str) -> str:
    """Text that must not be overlooked."""
    return f"<em>{text}</em>"


def note(text: str) -> str:
    """A remark below a table or a figure; `text` is HTML."""
    return f"<p class=note>{text}</p>"


def picture(kind: str, content: bytes, about: str, name: str = "") -> str:
    """A picture that stands in the page itself; `kind` is png or jpeg."""
    called = f" class={name}" if name else ""
    data = base64.b64encode(content).decode()
    return f"<img{called} alt='{escape(about)}' src='data:image/{kind};base64,{data}'>"


def _title(about: str) -> str:
    return f" title='{escape(about)}'" if about else ""
