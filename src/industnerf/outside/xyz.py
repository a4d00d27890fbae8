"""XYZ: a point a line, in text.  No two programs agree on what else stands in it.

Columns stand apart by blanks, tabs, commas or semicolons; those behind the third (colours,
normals) are passed over, as are comments, and up to TITLES lines of words before the points.
A count of points in the first line must be right.
"""

import re
from itertools import takewhile
from pathlib import Path

import numpy as np
from jaxtyping import Float64

from industnerf.errors import BadPart
from industnerf.parts.reading.formats import text_of

COMMENTS = ("#", "//")
TITLES = 2  # lines of words before the points: a title, and the names of the columns
BLANK = re.compile(r"(?:(?<=[,;])|^)\s*(?=[,;])")  # a column with nothing in it
Row = tuple[int, str]  # number of the line, and the line as it stands there


def read_xyz(file: Path) -> tuple[Float64[np.ndarray, "n 3"], list[str]]:
    """The points, an empty column being NaN; and a remark on the lines of words, if there are any.

    Raises BadPart that names the line that is no point.
    """
    lines = enumerate(text_of(file.read_bytes()).splitlines(), start=1)
    rows = [(n, line.strip()) for n, line in lines if line.strip()]
    rows = [(n, line) for n, line in rows if not line.startswith(COMMENTS)]
    promised, rows = _count(rows)
    titles = _titles(rows)  # before columns are looked at: words have commas of their own
    rows = rows[len(titles) :]
    points = [_point(number, line) for number, line in rows]
    if promised is not None and promised != len(rows):
        raise BadPart(f"XYZ: its first line promises {promised} points, it holds {len(rows)}")
    if not points:
        return np.zeros((0, 3)), _remarks(titles)
    table = np.loadtxt(points, usecols=(0, 1, 2), ndmin=2, comments=None)
    return table, _remarks(titles)


def _remarks(titles: list[Row]) -> list[str]:
    said = "; ".join(f"line {number}, {line[:60]!r}" for number, line in titles)
    return [f"passed over before its points: {said}"] if said else []


def _point(number: int, line: str) -> str:
    """The columns of the line, with blanks between; raises BadPart if they begin no point."""
    columns = _columns(number, line)
    words = columns.split(maxsplit=3)[:3]
    if len(words) < 3 or not all(map(_is_number, words)):
        raise BadPart(f"XYZ: line {number}, {line[:60]!r}, does not begin with three numbers")
    return columns


def _columns(number: int, line: str) -> str:
    if "," not in line and ";" not in line:
        return line
    if _has_decimal_commas(line):
        raise BadPart(
            f"XYZ: line {number}, {line[:60]!r}, has decimal commas; write decimal points"
        )
    return re.sub("[,;]", " ", BLANK.sub("nan", line))


def _has_decimal_commas(line: str) -> bool:
    """Whether a comma stands within numbers: `0,5 1,2 3` or `0,5;1,2;3`, or `0,05,1,20,3,00`."""
    if re.search(r",\s", line):  # then commas part columns, with a blank behind some of them
        return False
    words = re.split(r"[\s;]+", line)
    within = any(re.fullmatch(r"[-+.\d]+,\d+(e[-+]?\d+)?", word, re.I) for word in words)
    # no whole number begins with a nought, if it is not all of it
    return (within and len(words) > 1) or bool(re.search(r",0\d+(,|$)", line))


def _count(rows: list[Row]) -> tuple[int | None, list[Row]]:
    """The count of points in the first line, if it is one, and the rows behind it."""
    if rows and rows[0][1].isdecimal():
        return int(rows[0][1]), rows[1:]
    return None, rows


def _titles(rows: list[Row]) -> list[Row]:
    """The lines of words that `rows` begin with."""
    return list(takewhile(lambda row: _is_title(row[1]), rows[:TITLES]))


def _is_title(line: str) -> bool:
    """Whether it begins with a word, and not a point behind it: `foo 7 8 9` is a torn point."""
    words = re.findall(r"[^\s,;]+", line)[:4]
    if not words or _is_number(words[0]):
        return False
    behind = words[1:]
    return len(behind) < 2 or not all(map(_is_number, behind))  # `gear 24` is a title, too


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return "_" not in word  # Python's own way of grouping digits
