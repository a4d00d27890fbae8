"""XYZ: a point a line, in text.  No two programs agree on what else stands in it.

Columns stand apart by blanks, tabs, commas or semicolons; those behind the third (colors,
normals) are passed over, as are comments, and up to TITLES lines of words before the points.
A count of points in the first line must be right.
"""

import re
from itertools import takewhile
from pathlib import Path

import numpy as np
from jaxtyping import Float64

from industnerf.errors import BadPart
from industnerf.parts.io.readers.formats import decode_text

COMMENTS = ("#", "//")
MAX_TITLE_LINES = 2  # lines of words before the points: a title, and the names of the columns
EMPTY_COLUMN = re.compile(r"(?:(?<=[,;])|^)\s*(?=[,;])")  # a column with nothing in it
Row = tuple[int, str]  # number of the line, and the line as it stands there


def read_xyz(file: Path) -> tuple[Float64[np.ndarray, "n 3"], list[str]]:
    """The points, an empty column being NaN; and a remark on the lines of words, if there are any.

    Raises BadPart that names the line that is no point.
    """
    lines = enumerate(decode_text(file.read_bytes()).splitlines(), start=1)
    rows = [(n, line.strip()) for n, line in lines if line.strip()]
    rows = [(n, line) for n, line in rows if not line.startswith(COMMENTS)]
    declared_count, rows = _split_count(rows)
    titles = _titles(rows)  # before columns are looked at: words have commas of their own
    rows = rows[len(titles) :]
    points = [_point(number, line) for number, line in rows]
    if declared_count is not None and declared_count != len(rows):
        raise BadPart(f"XYZ: its first line promises {declared_count} points, it holds {len(rows)}")
    if not points:
        return np.zeros((0, 3)), _title_warnings(titles)
    table = np.loadtxt(points, usecols=(0, 1, 2), ndmin=2, comments=None)
    return table, _title_warnings(titles)


def _title_warnings(titles: list[Row]) -> list[str]:
    quoted = "; ".join(f"line {number}, {line[:60]!r}" for number, line in titles)
    return [f"passed over before its points: {quoted}"] if quoted else []


def _point(number: int, line: str) -> str:
    """The columns of the line, with blanks between; raises BadPart if they begin no point."""
    columns = _columns(number, line)
    tokens = columns.split(maxsplit=3)[:3]
    if len(tokens) < 3 or not all(map(_is_number, tokens)):
        raise BadPart(f"XYZ: line {number}, {line[:60]!r}, does not begin with three numbers")
    return columns


def _columns(number: int, line: str) -> str:
    if "," not in line and ";" not in line:
        return line
    if _has_decimal_commas(line):
        raise BadPart(
            f"XYZ: line {number}, {line[:60]!r}, has decimal commas; write decimal points"
        )
    return re.sub("[,;]", " ", EMPTY_COLUMN.sub("nan", line))


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
