"""A published sweep read back from its sweep.csv: enough to draw it anew."""

from pathlib import Path

from industnerf.report.formats import csv_rows
from industnerf.report.sweep_points import Point, Result

Cells = dict[str, str]
COLUMNS = ("emd", "low", "high", "x floor")


def reread_sweep(folder: Path) -> tuple[list[Point], list[str]]:
    """The points of `folder`, and what was swept; of no part by itself is anything known."""
    rows = csv_rows(folder / "sweep.csv")
    heads = list(rows[0])
    swept = heads[1 : heads.index("method")]
    numbers = dict.fromkeys(int(row["point"]) for row in rows)
    return [
        _point(number, [row for row in rows if int(row["point"]) == number], swept)
        for number in numbers
    ], swept


def _point(number: int, rows: list[Cells], swept: list[str]) -> Point:
    params = {key: _value(rows[0][key]) for key in swept}
    return Point(number, params, 0.0, [_result(row) for row in rows], {})


def _value(text: str) -> int | float | str:
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            pass
    return text


def _result(row: Cells) -> Result:
    emd, low, high, ratio = (float(row[name]) for name in COLUMNS)
    mm, seconds, peak_mb = (_known(row, name) for name in ("emd_mm", "seconds", "peak_mb"))
    numbers = int(row["numbers"]) if row.get("numbers") else None
    means = (emd, low, high, mm, ratio)
    return Result(row["method"], row["split"], *means, seconds, peak_mb, numbers, {})


def _known(row: Cells, name: str) -> float | None:
    """None where the cell is empty, or the table is of before it had that column."""
    return float(row[name]) if row.get(name) else None
