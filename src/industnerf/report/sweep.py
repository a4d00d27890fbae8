"""After a sweep: a table of its points, and a plot of EMD against what was swept."""

import csv
import io
import json
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console
from rich.table import Table

from industnerf.artifacts.files import write_text
from industnerf.config import flat, read_yaml


@dataclass(frozen=True)
class Point:
    """One finished point of a sweep."""

    number: int
    params: dict[str, str]
    metrics: dict[str, float]


def write_sweep(folder: Path) -> int:
    """Write `sweep.csv` and `sweep.png` into `folder`, print the table; returns failed points."""
    started = sorted(folder.glob("*/params.yaml"), key=lambda path: int(path.parent.name))
    points = [_read(path.parent) for path in started if _summary(path.parent).exists()]
    failed = len([p for p in folder.iterdir() if p.name.isdigit()]) - len(points)
    if points:
        swept = swept_keys(points)
        methods = sorted({name.rsplit(".", 1)[0] for p in points for name in p.metrics})
        lines = _lines(points, swept, methods)
        text = io.StringIO()
        csv.writer(text, lineterminator="\n").writerows(lines)
        write_text(folder / "sweep.csv", text.getvalue())
        _plot(points, swept, methods, folder / "sweep.png")
        _show(lines, folder)
    return failed


def swept_keys(points: list[Point]) -> list[str]:
    """The parameters that differ between points, or `preset` where none does."""
    keys = [key for key in points[0].params if len({str(p.params[key]) for p in points}) > 1]
    return keys or ["preset"]


def _summary(point: Path) -> Path:
    return point / "reports" / "summary.json"


def _read(point: Path) -> Point:
    metrics = json.loads(_summary(point).read_text())["metrics"]
    return Point(int(point.name), flat(read_yaml(point / "params.yaml")), metrics)


def _lines(points: list[Point], swept: list[str], methods: list[str]) -> list[list[str]]:
    head = ["point", *swept, *(f"{m} {name}" for m in methods for name in ("emd", "x floor"))]
    lines = [head]
    for p in points:
        pairs = [
            (p.metrics.get(f"{m}.emd_even"), p.metrics.get(f"{m}.ratio_to_floor")) for m in methods
        ]
        numbers = [f"{n:.5f}" if n is not None else "" for pair in pairs for n in pair]
        lines.append([str(p.number), *(str(p.params[key]) for key in swept), *numbers])
    return lines


def _plot(points: list[Point], swept: list[str], methods: list[str], path: Path) -> None:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.4, 4.2), layout="constrained")
    axis = figure.subplots()
    x = [p.params[swept[0]] for p in points]
    numeric = all(isinstance(value, int | float) for value in x)
    for method in methods:
        pairs = [(at, p.metrics.get(f"{method}.emd_even")) for at, p in zip(x, points, strict=True)]
        known = [pair for pair in pairs if pair[1] is not None]
        ordered = sorted(known) if numeric else [(str(at), value) for at, value in known]
        axis.plot(*zip(*ordered, strict=True), marker="o", label=method)
    axis.set(xlabel=swept[0], ylabel="EMD (even), bounding-box diagonals")
    axis.set_ylim(bottom=0)
    axis.legend()
    figure.savefig(path, dpi=120)


def _show(lines: list[list[str]], folder: Path) -> None:
    table = Table(*lines[0], title="EMD over the sweep")
    for line in lines[1:]:
        table.add_row(*line)
    console = Console()
    console.print(table)
    console.print(f"{folder / 'sweep.csv'}, {folder / 'sweep.png'}", markup=False)
