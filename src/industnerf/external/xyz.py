"""XYZ, CSV, TXT, PTS, ASC: a point a line, in text.  No two programs agree on what else is there.

Columns stand apart by blanks, tabs, commas or semicolons.  A line of names before the points, be it
a comment, says which are x, y and z; else the first three are.  Three whole numbers up to 255 at
the end of each line are a color, if the names say so or there are none.  Comments are passed over,
and so are up to MAX_TITLE_LINES of words.  A count of points in the first line must be right.
"""

import re
from itertools import takewhile
from pathlib import Path

import numpy as np
from jaxtyping import UInt8

from industnerf.errors import BadPart
from industnerf.external.cloud_content import CloudContent
from industnerf.parts.io.readers.formats import decode_text

COMMENTS = ("#", "//")
COLOR_NAMES = ("r", "g", "b", "red", "green", "blue")
HEAD_BYTES = 1 << 16  # looked at to tell points from notes
MAX_TITLE_LINES = 2  # lines of words before the points: a title, and the names of the columns
EMPTY_COLUMN = re.compile(r"(?:(?<=[,;])|^)\s*(?=[,;])")  # a column with nothing in it
Row = tuple[int, str]  # number of the line, and the line as it stands there


def read_xyz(file: Path) -> CloudContent:
    """The points, an empty column being NaN; and a remark on the lines of words, if there are any.

    Raises BadPart that names the line that is no point.
    """
    declared_count, rows, titles, header = _split(file.read_bytes())
    axes = _named_axes(header)
    points = [_point(number, line, axes) for number, line in rows]
    if declared_count is not None and declared_count != len(rows):
        raise BadPart(f"XYZ: its first line promises {declared_count} points, it holds {len(rows)}")
    if not points:
        return CloudContent(np.zeros((0, 3)), _title_warnings(titles, axes))
    table = np.loadtxt(points, usecols=axes, ndmin=2, comments=None)
    return CloudContent(table, _title_warnings(titles, axes), colors=_colors(points, header))


def looks_like_points(file: Path) -> bool:
    """Whether the text in `file` begins with a point, behind titles and comments: notes do not."""
    with file.open("rb") as stream:
        data = stream.read(HEAD_BYTES)
    _, rows, _, header = _split(data)
    try:
        return bool(rows) and bool(_point(*rows[0], _named_axes(header)))
    except BadPart as error:
        return "decimal commas" in str(error)  # points, which are refused for them by name


def _split(data: bytes) -> tuple[int | None, list[Row], list[Row], str]:
    """The count that is promised, the points, the titles before them, and the last such line."""
    lines = enumerate(decode_text(data).splitlines(), start=1)
    stripped = [(n, line.strip()) for n, line in lines if line.strip()]
    rows = [(n, line) for n, line in stripped if not line.startswith(COMMENTS)]
    declared_count, rows = _split_count(rows)
    titles = _titles(rows)  # before columns are looked at: words have commas of their own
    rows = rows[len(titles) :]
    start = rows[0][0] if rows else 0
    heads = [line for n, line in stripped if n < start and not line.isdecimal()]
    return declared_count, rows, titles, heads[-1] if heads else ""


def _names(header: str) -> list[str]:
    """The names of columns in a line: without quotes, comment marks or units, in lower case."""
    bare = re.sub(r"[\[(].*?[\])]", "", header.lower()).lstrip("#/").replace('"', "")
    return [name for name in re.split(r"[\s,;]+", bare) if name]


def _named_axes(header: str) -> tuple[int, int, int]:
    names = _names(header)
    if all(names.count(axis) == 1 for axis in "xyz"):
        x, y, z = (names.index(axis) for axis in "xyz")
        return x, y, z
    return 0, 1, 2


def _colors(points: list[str], header: str) -> UInt8[np.ndarray, "n 3"] | None:
    """The last three columns, where they are colors."""
    names, width = _names(header), len(points[0].split())
    named = [i for i, name in enumerate(names) if name in COLOR_NAMES]
    if len(named) != 3 and (named or set("xyz") <= set(names) or width not in (6, 7)):
        return None
    columns = named or range(width - 3, width)
    try:
        table = np.loadtxt(points, usecols=columns, ndmin=2, comments=None)
    except (ValueError, IndexError):  # not in every line, or no numbers
        return None
    is_color = (table == np.rint(table)).all() and table.min() >= 0 and 1 < table.max() <= 255
    return table.astype(np.uint8) if is_color else None


def _title_warnings(titles: list[Row], axes: tuple[int, int, int]) -> tuple[str, ...]:
    quoted = "; ".join(f"line {number}, {line[:60]!r}" for number, line in titles)
    warnings = [f"passed over before its points: {quoted}"] if quoted else []
    if axes != (0, 1, 2):
        places = ", ".join(str(axis + 1) for axis in axes)
        warnings.append(f"x, y, z are its columns {places}, by their names")
    return tuple(warnings)


def _point(number: int, line: str, axes: tuple[int, int, int]) -> str:
    """The columns of the line, with blanks between; raises BadPart if they hold no point."""
    columns = _columns(number, line)
    tokens = columns.split(maxsplit=max(axes) + 1)
    if len(tokens) <= max(axes) or not all(_is_number(tokens[axis]) for axis in axes):
        if axes == (0, 1, 2):
            raise BadPart(f"XYZ: line {number}, {line[:60]!r}, does not begin with three numbers")
        places = ", ".join(str(axis + 1) for axis in axes)
        raise BadPart(f"XYZ: line {number}, {line[:60]!r}, has no numbers in columns {places}")
    return columns


def _columns(number: int, line: str) -> str:
    if "," not in line and ";" not in line:
        return line
    if _has_decimal_commas(line):
        raise BadPart(
            f"XYZ: line {number}, {line[:60]!r}, has decimal commas; write decimal points"
        )
    return re.sub("[,;]", " ", EMPTY_COLUMN.sub("nan", line.replace('"', "")))


def _has_decimal_commas(line: str) -> bool:
    """Whether a comma stands within numbers: `0,5 1,2 3` or `0,5;1,2;3`, or `0,05,1,20,3,00`."""
    if re.search(r",\s", line):  # then commas part columns, with a blank behind some of them
        return False
    tokens = re.split(r"[\s;]+", line)
    has_comma_within = any(
        re.fullmatch(r"[-+.\d]+,\d+(e[-+]?\d+)?", token, re.I) for token in tokens
    )
    # no whole number begins with a nought, if it is not all of it
    return (has_comma_within and len(tokens) > 1) or bool(re.search(r",0\d+(,|$)", line))


def _split_count(rows: list[Row]) -> tuple[int | None, list[Row]]:
    """The count of points in the first line, if it is one, and the rows behind it."""
    if rows and rows[0][1].isdecimal():
        return int(rows[0][1]), rows[1:]
    return None, rows


def _titles(rows: list[Row]) -> list[Row]:
    """The lines of words that `rows` begin with."""
    return list(takewhile(lambda row: _is_title(row[1]), rows[:MAX_TITLE_LINES]))


def _is_title(line: str) -> bool:
    """Whether it begins with a word, and not a point behind it: `foo 7 8 9` is a torn point."""
    tokens = re.findall(r"[^\s,;]+", line)[:4]
    if not tokens or _is_number(tokens[0]):
        return False
    rest = tokens[1:]
    return len(rest) < 2 or not all(map(_is_number, rest))  # `gear 24` is a title, too


def _is_number(token: str) -> bool:
    try:
        float(token)
    except ValueError:
        return False
    return "_" not in token  # Python's own way of grouping digits
