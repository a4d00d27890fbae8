"""XYZ: a point a line, in text.  No two programs agree on what else stands in it.

Columns stand apart by blanks, tabs, commas or semicolons; those behind the third (colours,
normals) are passed over, as are comments, up to TITLES lines of words, and a count of points.
"""

import re
from pathlib import Path

import numpy as np
from jaxtyping import Float64

from industnerf.errors import BadPart
from industnerf.parts.reading.formats import text_of

COMMENTS = ("#", "//")
TITLES = 2  # lines of words before the points: a title, and the names of the columns
BLANK = re.compile(r"(?:(?<=[,;])|^)\s*(?=[,;])")  # a column with nothing in it
Row = tuple[int, str]  # number of the line, and its columns with blanks between


def read_xyz(file: Path) -> Float64[np.ndarray, "n 3"]:
    """The points; an empty column is NaN.  Raises BadPart that names the line that is no point."""
    lines = enumerate(text_of(file.read_bytes()).splitlines(), start=1)
    rows = [(n, line.strip()) for n, line in lines if line.strip()]
    rows = [(n, _columns(n, line)) for n, line in rows if not line.startswith(COMMENTS)]
    promised, rows = _count(rows)
    rows = _without_titles(rows)
    for row in rows:
        _require_point(row)
    if promised is not None and promised != len(rows):
        raise BadPart(f"XYZ: its first line promises {promised} points, it holds {len(rows)}")
    if not rows:
        return np.zeros((0, 3))
    return np.loadtxt([line for _, line in rows], usecols=(0, 1, 2), ndmin=2, comments=None)


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
    words = re.split(r"[\s;]+", line)
    within = any(re.fullmatch(r"[-+.\d]+,\d+(e[-+]?\d+)?", word, re.I) for word in words)
    # no whole number begins with a nought, if it is not all of it
    return (within and len(words) > 1) or bool(re.search(r",0\d+(,|$)", line))


def _count(rows: list[Row]) -> tuple[int | None, list[Row]]:
    """The count of points in the first line, if it is one, and the rows behind it."""
    if rows and rows[0][1].isdecimal():
        return int(rows[0][1]), rows[1:]
    return None, rows


def _without_titles(rows: list[Row]) -> list[Row]:
    titles = 0
    while titles < min(TITLES, len(rows)) and not _is_number(rows[titles][1].split()[0]):
        titles += 1
    return rows[titles:]


def _require_point(row: Row) -> None:
    number, line = row
    words = line.split(maxsplit=3)[:3]
    if len(words) < 3 or not all(map(_is_number, words)):
        raise BadPart(f"XYZ: line {number}, {line[:60]!r}, does not begin with three numbers")


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return "_" not in word  # Python's own way of grouping digits
