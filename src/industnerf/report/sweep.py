"""After a sweep: a table of its points, what each step changes, how costs grow, and a plot.

sweep.csv    a row a point, method and split: EMD with interval and in mm, costs, numbers learned
steps.csv    from each point to the next: the mean paired difference of the EMD, with its interval
trend.csv    exponents of seconds and memory, where what is swept is a number
sweep.png    the same
"""

from pathlib import Path

from rich.box import SIMPLE
from rich.console import Console
from rich.table import Table

from industnerf.artifacts.files import write_text
from industnerf.report import sweep_steps
from industnerf.report.formats import csv_text, short
from industnerf.report.sweep_plot import plot
from industnerf.report.sweep_points import Point, Result, read_points, swept_keys, unfinished
from industnerf.report.sweep_series import Trend, series, trends

COLUMNS = (
    "method",
    "split",
    "emd",
    "low",
    "high",
    "emd_mm",
    "x floor",
    "seconds",
    "peak_mb",
    "numbers",
)
ONLY_IN_FILES = (
    "point",
    "split",
    "low",
    "high",
    "emd_mm",
    "numbers",
)  # the others fit into 80 characters


def write_sweep(folder: Path) -> int:
    """Write the four files into `folder`, print the tables; returns failed points."""
    points = read_points(folder)
    if points:
        swept = swept_keys(points)
        lines = series(points, swept)
        found = trends(lines, swept[0])
        table, growth = _table(points, swept), _growth(found)
        changes = sweep_steps.table(sweep_steps.steps(lines, points))
        write_text(folder / "sweep.csv", csv_text(table[0], table[1:]))
        write_text(folder / "steps.csv", csv_text(changes[0], changes[1:]))
        write_text(folder / "trend.csv", csv_text(growth[0], growth[1:]))
        plot(lines, found, swept[0], folder / "sweep.png")
        _show(table, changes, growth, folder)
    return unfinished(folder)


def _table(points: list[Point], swept: list[str]) -> list[list[str]]:
    head = ["point", *swept, *COLUMNS]
    return [head] + [_line(p, swept, r) for p in points for r in p.results]


def _line(point: Point, swept: list[str], result: Result) -> list[str]:
    costs = ["" if cost is None else f"{cost:.2f}" for cost in (result.seconds, result.peak_mb)]
    emd = [f"{value:.5f}" for value in (result.emd, result.low, result.high)]
    keys = [str(point.params.get(key)) for key in swept]
    means = [*emd, short(result.emd_mm), f"{result.ratio:.3f}"]
    numbers = "" if result.numbers is None else str(result.numbers)
    return [str(point.number), *keys, result.method, result.split, *means, *costs, numbers]


def _growth(found: list[Trend]) -> list[list[str]]:
    head = ["series", "quantity", "exponent", "standard error", "points"]
    return [head] + [
        [t.label, t.quantity, f"{t.law.exponent:.3f}", f"{t.law.error:.3f}", str(t.law.points)]
        for t in found
    ]


def _show(
    table: list[list[str]], changes: list[list[str]], growth: list[list[str]], folder: Path
) -> None:
    console, titles = Console(), ("EMD over the sweep", "From point to point", "How costs grow")
    for title, lines in zip(titles, (table, changes, growth), strict=True):
        wanted = [i for i, name in enumerate(lines[0]) if name not in ONLY_IN_FILES]
        shown = Table(*(lines[0][i] for i in wanted), title=title, box=SIMPLE, padding=(0, 1))
        for line in lines[1:]:
            shown.add_row(*(line[i] for i in wanted))
        if len(lines) > 1:
            console.print(shown)
    console.print(f"{folder / 'sweep.csv'}, {folder / 'sweep.png'}", markup=False)
