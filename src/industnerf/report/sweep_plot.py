"""The plot of a sweep: EMD, seconds and memory over what was swept, and EMD against its price."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from industnerf.report.pareto import front, name_points
from industnerf.report.sweep_points import SELECT
from industnerf.report.sweep_series import COSTS, Series, Trend

SPAN = 4  # numbers that span more than this factor stand on a logarithmic axis
SETTING = "method."  # of the method, and so the points are of the same task and compete
FRONT = "#d1495b"
HEADROOM = 1.2  # times the largest value
# Of the height of an axis: beside what is drawn, a row of a legend, and the most that is left free.
MARGIN, ROW, FREE = 0.08, 0.09, 0.5
NAMES = {"seconds": "s a part", "peak_mb": "peak MB", "numbers": "numbers learned"}
CHEAPER = {"seconds": "quicker", "numbers": "smaller"}


def plot(lines: list[Series], trends: list[Trend], key: str, path: Path) -> None:
    """Write the PNG `path`; a dashed line is a fitted power law, the legend has its exponent."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.4, 10.6), layout="constrained")
    above, below = figure.subfigures(2, 1, height_ratios=(3, 1))
    emd, *costs = above.subplots(1 + len(COSTS), 1, sharex=True)
    price = _price(lines, key)
    _exchange(exchange := below.subplots(), lines, price)
    if key.startswith(SETTING) and len(lines) == 1:
        _front(exchange, lines[0], price)
    for i, line in enumerate(lines):
        _emd(emd, line, f"C{i}")
        for axis, quantity in zip(costs, COSTS, strict=True):
            law = next((t for t in trends if (t.label, t.quantity) == (line.label, quantity)), None)
            _cost(axis, line, quantity, law, f"C{i}")
    emd.set(ylabel="EMD (even), diagonals")
    emd.set_ylim(bottom=0)
    above.legend(
        *emd.get_legend_handles_labels(), fontsize="small", loc="outside upper center", ncols=3
    )
    for axis, quantity in zip(costs, COSTS, strict=True):
        _vertical(axis, NAMES[quantity])
        if axis.get_legend_handles_labels()[1]:
            axis.legend(fontsize="small")
    _horizontal(costs[-1], lines, key)
    named = [(*at, f"C{i}") for i, line in enumerate(lines) for at in _bought(line, price)]
    name_points(exchange, named, 7)
    figure.savefig(path, dpi=100)


def _emd(axis: Any, line: Series, colour: str) -> None:
    y = np.array([result.emd for result in line.results])
    below = y - [result.low for result in line.results]
    above = [result.high for result in line.results] - y
    # a percentile interval need not hold the mean
    bars = np.maximum([below, above], 0)
    axis.errorbar(line.x, y, bars, marker="o", capsize=3, color=colour, label=line.label)


def _cost(axis: Any, line: Series, quantity: str, trend: Trend | None, colour: str) -> None:
    known = [(x, getattr(r, quantity)) for x, r in zip(line.x, line.results, strict=True)]
    pairs = [(x, y) for x, y in known if y is not None]
    if not pairs:
        return
    axis.plot([x for x, _ in pairs], [y for _, y in pairs], "o" if trend else "o-", color=colour)
    if trend:
        x = np.array([x for x in line.x if x > 0])
        label = f"{line.label}: exponent {trend.law.exponent:z.2f} ± {trend.law.error:.2f}"
        axis.plot(x, trend.law.factor * x**trend.law.exponent, "--", color=colour, label=label)


def _vertical(axis: Any, name: str) -> None:
    """From 0 or logarithmic, with room for the legend above all that is drawn."""
    axis.set_ylabel(name)
    found = [float(y) for line in axis.lines for y in line.get_ydata()]
    above = min(MARGIN + ROW * len(axis.get_legend_handles_labels()[1]), FREE)
    if _wide(found):
        height = (max(found) / min(found)) ** (1 / (1 - MARGIN - above))
        _logarithmic(axis, "y")
        axis.set_ylim(min(found) / height**MARGIN, max(found) * height**above)
    elif found:
        axis.set_ylim(0, max(found) / (1 - above))


def _logarithmic(axis: Any, which: str) -> None:
    """Labels at 1, 2, 5, 10, 20: never none, and they do not run into each other."""
    from matplotlib.ticker import LogLocator, NullFormatter

    axis.set(**{f"{which}scale": "log"})
    ticks = getattr(axis, f"{which}axis")
    ticks.set_major_locator(LogLocator(subs=(1, 2, 5)))
    ticks.set_major_formatter("{x:g}")
    ticks.set_minor_formatter(NullFormatter())


def _wide(values: Sequence[float | int]) -> bool:
    """Whether `values` go onto a logarithmic axis, which has no label within a small span."""
    return bool(values) and min(values) > 0 and max(values) > SPAN * min(values)


def _price(lines: list[Series], key: str) -> str:
    """Numbers learned, where a setting changes how many and all learn some; else seconds."""
    counts = [[result.numbers for result in line.results] for line in lines]
    varied = any(len(set(each)) > 1 for each in counts)
    known = all(number for each in counts for number in each)
    return "numbers" if key.startswith(SETTING) and varied and known else "seconds"


def _exchange(axis: Any, lines: list[Series], price: str) -> None:
    """What a higher price buys, a line a method."""
    for i, line in enumerate(lines):
        known = _bought(line, price)
        axis.plot([paid for paid, _, _ in known], [emd for _, emd, _ in known], "o-", color=f"C{i}")
    axis.set(xlabel=NAMES[price], ylabel="EMD (even), diagonals")
    axis.margins(0.1)  # for what stands beside the points
    axis.set_ylim(0, HEADROOM * max(result.emd for line in lines for result in line.results))
    paid = [getattr(result, price) for line in lines for result in line.results]
    if _wide([each for each in paid if each]):
        _logarithmic(axis, "x")


def _bought(line: Series, price: str) -> list[tuple[float, float, str]]:
    """Price, EMD, and where in the sweep it stands, of each point whose price is known."""
    return [
        (float(getattr(result, price)), result.emd, f"{x:g}" if line.numeric else x)
        for x, result in zip(line.x, line.results, strict=True)
        if getattr(result, price) is not None
    ]


def _front(axis: Any, line: Series, price: str) -> None:
    """A red line through the points that no other is at or below in both coordinates."""
    paid = [(getattr(result, price), result.emd) for result in line.results]
    best = front([(float(each), emd) for each, emd in paid if each is not None])
    if best:
        how = {"where": "post", "color": FRONT, "label": f"no point is {CHEAPER[price]} and better"}
        axis.step(*zip(*best, strict=True), "o-", **how)
        axis.legend(fontsize="small")


def _horizontal(axis: Any, lines: list[Series], key: str) -> None:
    axis.set_xlabel("faces of the part" if key == SELECT else key)
    if not all(line.numeric for line in lines):
        axis.tick_params(axis="x", labelrotation=20)
        return
    x = [each for line in lines for each in line.x]
    if _wide(x):
        axis.set_xscale("log")
        axis.set_xticks(sorted(set(x)), [f"{each:g}" for each in sorted(set(x))])
        axis.minorticks_off()
