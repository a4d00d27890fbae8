"""A published sweep read back from its sweep.csv: enough to draw it anew."""

from pathlib import Path

from industnerf.report.sweeps.points import PointResult, SweepPoint
from industnerf.report.tables.formats import read_csv

CsvRow = dict[str, str]
COLUMNS = ("emd", "low", "high", "x floor")


def read_published_sweep(folder: Path) -> tuple[list[SweepPoint], list[str]]:
    """The points of `folder`, and what was swept; of no part by itself is anything known."""
    rows = read_csv(folder / "sweep.csv")
    heads = list(rows[0])
    swept = heads[1 : heads.index("method")]
    numbers = dict.fromkeys(int(row["point"]) for row in rows)
    return [
        _point(number, [row for row in rows if int(row["point"]) == number], swept)
        for number in numbers
    ], swept


def _point(number: int, rows: list[CsvRow], swept: list[str]) -> SweepPoint:
    params = {key: _parse_value(rows[0][key]) for key in swept}
    return SweepPoint(number, params, 0.0, [_result(row) for row in rows], {})


def _parse_value(text: str) -> int | float | str:
    for convert in (int, float):
        try:
            return convert(text)
        except ValueError:
            pass
    return text


def _result(row: CsvRow) -> PointResult:
    emd, low, high, ratio = (float(row[name]) for name in COLUMNS)
    emd_mm, seconds, peak_mb = (
        _optional_float(row, name) for name in ("emd_mm", "seconds", "peak_mb")
    )
    num_parameters = int(row["parameters"]) if row.get("parameters") else None
    means = (emd, low, high, emd_mm, ratio)
    return PointResult(row["method"], row["split"], *means, seconds, peak_mb, num_parameters, {})


def _optional_float(row: CsvRow, name: str) -> float | None:
    """None where the cell is empty, or the table is of before it had that column."""
    return float(row[name]) if row.get(name) else None
