"""The few pieces of HTML that the page is made of."""

import base64
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from urllib.parse import quote


@dataclass(frozen=True)
class Column:
    """One column of a table."""

    header: str
    is_text: bool = False  # words, set flush left and sorted by name; else numbers
    tooltip: str = ""  # shown when the pointer rests on the heading


@dataclass(frozen=True)
class HtmlRow:
    """One row: a cell for each column, as HTML."""

    cells: list[str]
    css_class: str = ""  # failed or aside, or nothing


def html_table(columns: Sequence[Column], rows: Sequence[HtmlRow]) -> str:
    """A table that sorts by a click on a heading, without the columns that no line fills."""
    filled = [i for i in range(len(columns)) if any(row.cells[i] for row in rows)]
    class_attributes = [" class=text" if columns[i].is_text else "" for i in filled]
    head = "".join(
        f"<th{class_attribute} scope=col aria-sort=none{_tooltip_attribute(columns[i].tooltip)}>"
        f"<button>{escape(columns[i].header)}</button>"
        for i, class_attribute in zip(filled, class_attributes, strict=True)
    )
    body = "".join(
        f"<tr{f' class={row.css_class}' if row.css_class else ''}>"
        + "".join(
            f"<td{class_attribute}>{row.cells[i]}"
            for i, class_attribute in zip(filled, class_attributes, strict=True)
        )
        for row in rows
    )
    return f"<div class=wide><table><thead><tr>{head}</thead><tbody>{body}</tbody></table></div>"


def part_link(part_id: str, text: str) -> str:
    """A link to the section of a part."""
    return f"<a href='{part_href(part_id)}'>{escape(text)}</a>"


def part_href(part_id: str) -> str:
    """The section of a part, as a link names it."""
    return "#" + quote(part_anchor(part_id), safe="=")


def part_anchor(part_id: str) -> str:
    """What the section of a part is called within the page."""
    return f"part={part_id}"


def details_html(title: str, text: str) -> str:
    """`text`, HTML, behind a title that opens it."""
    return f"<details><summary>{escape(title)}</summary>{text}</details>"


def emphasized(text: str) -> str:
    """Text that must not be overlooked."""
    return f"<em>{text}</em>"


def note(text: str) -> str:
    """A remark below a table or a figure; `text` is HTML."""
    return f"<p class=note>{text}</p>"


def image_html(image_format: str, content: bytes, alt_text: str, css_class: str = "") -> str:
    """A picture that stands in the page itself; `kind` is png or jpeg."""
    class_attribute = f" class={css_class}" if css_class else ""
    data = base64.b64encode(content).decode()
    return f"<img{class_attribute} alt='{escape(alt_text)}' src='data:image/{image_format};base64,{data}'>"


def _tooltip_attribute(tooltip: str) -> str:
    return f" title='{escape(tooltip)}'" if tooltip else ""
