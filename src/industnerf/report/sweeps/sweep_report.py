"""The report of a sweep: a table of its points, changes per step, growth of costs, a plot.

sweep.csv    a row per point, method and split: EMD, interval, mm, costs, learned parameters
steps.csv    from each point to the next: the mean paired difference of the EMD, with its interval
trend.csv    exponents of seconds and memory, where the swept key is a number
sweep.png    the same
"""

from pathlib import Path

from rich.box import SIMPLE
from rich.console import Console
from rich.table import Table

from industnerf.artifacts.files import write_text
from industnerf.report.sweeps.plot import plot_sweep
from industnerf.report.sweeps.points import (
    PointResult,
    SweepPoint,
    count_unfinished,
    read_points,
    swept_keys,
)
from industnerf.report.sweeps.series import Trend, fit_trends, make_series, step_changes, step_table
from industnerf.report.tables.formats import csv_text, format_fixed

COLUMNS = (
    *("method", "split", "emd", "low", "high", "emd_mm", "x floor", "seconds", "peak_mb"),
    "parameters",
)
# Left out of the printed table, which has 80 characters.
FILE_ONLY_COLUMNS = ("point", "split", "low", "high", "emd_mm", "parameters")


def write_sweep_report(folder: Path) -> int:
    """Write the four files into `folder` and print the tables; returns how many points failed."""
    points = read_points(folder)
    if points:
        swept = swept_keys(points)
        series_list = make_series(points, swept)
        fitted = fit_trends(series_list, swept[0])
        point_rows, trend_rows = _point_rows(points, swept), _trend_rows(fitted)
        step_rows = step_table(step_changes(series_list, points))
        write_text(folder / "sweep.csv", csv_text(point_rows[0], point_rows[1:]))
        write_text(folder / "steps.csv", csv_text(step_rows[0], step_rows[1:]))
        write_text(folder / "trend.csv", csv_text(trend_rows[0], trend_rows[1:]))
        plot_sweep(series_list, fitted, swept[0], folder / "sweep.png")
        _print_tables(point_rows, step_rows, trend_rows, folder)
    return count_unfinished(folder)


def _point_rows(points: list[SweepPoint], swept: list[str]) -> list[list[str]]:
    head = ["point", *swept, *COLUMNS]
    return [head] + [_point_row(p, swept, r) for p in points for r in p.results]


def _point_row(point: SweepPoint, swept: list[str], result: PointResult) -> list[str]:
    costs = ["" if cost is None else f"{cost:.2f}" for cost in (result.seconds, result.peak_mb)]
    emd = [format_fixed(value, 5) for value in (result.emd, result.low, result.high)]
    keys = [str(point.params.get(key)) for key in swept]
    means = [*emd, format_fixed(result.emd_mm), f"{result.ratio_to_floor:.3f}"]
    parameters = "" if result.num_parameters is None else str(result.num_parameters)
    return [str(point.number), *keys, result.method, result.split, *means, *costs, parameters]


def _trend_rows(fitted: list[Trend]) -> list[list[str]]:
    head = ["series", "quantity", "exponent", "standard error", "points"]
    return [head] + [
        [t.label, t.quantity, f"{t.law.exponent:.3f}", f"{t.law.error:.3f}", str(t.law.points)]
        for t in fitted
    ]


def _print_tables(
    point_rows: list[list[str]],
    step_rows: list[list[str]],
    trend_rows: list[list[str]],
    folder: Path,
) -> None:
    console, titles = Console(), ("EMD over the sweep", "From point to point", "How costs grow")
    for title, rows in zip(titles, (point_rows, step_rows, trend_rows), strict=True):
        indices = [i for i, name in enumerate(rows[0]) if name not in FILE_ONLY_COLUMNS]
        table = Table(*(rows[0][i] for i in indices), title=title, box=SIMPLE, padding=(0, 1))
        for row in rows[1:]:
            table.add_row(*(row[i] for i in indices))
        if len(rows) > 1:
            console.print(table)
    console.print(f"{folder / 'sweep.csv'}, {folder / 'sweep.png'}", markup=False)
