"""The plot of a sweep: EMD, seconds and memory over the swept key, and EMD against cost."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from industnerf.report.figures.pareto import label_points, pareto_front
from industnerf.report.sweeps.points import SELECT_KEY
from industnerf.report.sweeps.series import COST_QUANTITIES, Series, Trend

LINEAR_SPAN = 4  # values that span a larger factor get a logarithmic axis
METHOD_PREFIX = "method."  # settings of a method: the points are of one task and compete
FRONT_COLOR = "black"
HEADROOM = 1.2  # times the largest value
# Shares of the height of an axis: free above the data, a row of a legend, the most of a legend.
MARGIN, LEGEND_ROW, MAX_LEGEND_SHARE = 0.08, 0.09, 0.5
AXIS_LABELS = {"seconds": "s a part", "peak_mb": "peak MB", "num_parameters": "learned parameters"}
METHOD_COLORS = {  # the same in every plot
    "industnerf_plus": "C0",
    "hull": "C1",
    "carve": "C2",
    "industnerf": "C3",
    "r2n2": "C4",
    "atlasnet": "C5",
    "occupancy": "C6",
    "tsdf": "C7",
    "hull_rgb": "C8",
    "nerf": "C9",
}
CHEAPER_WORDS = {"seconds": "faster", "num_parameters": "smaller"}


def plot_sweep(series_list: list[Series], trends: list[Trend], key: str, path: Path) -> None:
    """Write the PNG `path`; dashed lines are fitted power laws, whose exponents the legend has."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.4, 10.6), layout="constrained")
    above, below = figure.subfigures(2, 1, height_ratios=(3, 1))
    emd_axis, *costs = above.subplots(1 + len(COST_QUANTITIES), 1, sharex=True)
    price_quantity = _price_quantity(series_list, key)
    colors = _series_colors([series.label for series in series_list])
    _plot_tradeoff(tradeoff_axis := below.subplots(), series_list, colors, price_quantity)
    if key.startswith(METHOD_PREFIX) and len(series_list) == 1:
        _plot_front(tradeoff_axis, series_list[0], price_quantity)
    for series, color in zip(series_list, colors, strict=True):
        _plot_emd(emd_axis, series, color)
        for axis, quantity in zip(costs, COST_QUANTITIES, strict=True):
            trend = next(
                (t for t in trends if (t.label, t.quantity) == (series.label, quantity)), None
            )
            _plot_cost(axis, series, quantity, trend, color)
    emd_axis.set(ylabel="EMD (even), diagonals")
    top = max(max(r.emd, r.high or 0.0) for series in series_list for r in series.results)
    emd_axis.set_ylim(0, HEADROOM * top)
    above.legend(
        *emd_axis.get_legend_handles_labels(), fontsize="small", loc="outside upper center", ncols=3
    )
    for axis, quantity in zip(costs, COST_QUANTITIES, strict=True):
        _set_y_axis(axis, AXIS_LABELS[quantity])
        if axis.get_legend_handles_labels()[1]:
            axis.legend(fontsize="small")
    _set_x_axis(costs[-1], series_list, key)
    labeled_points = [
        (*point, color)
        for series, color in zip(series_list, colors, strict=True)
        for point in _tradeoff_points(series, price_quantity)
    ]
    label_points(tradeoff_axis, labeled_points, 7)
    figure.savefig(path, dpi=100)


def _series_colors(labels: Sequence[str]) -> list[str]:
    """Those of the methods that the labels begin with, if these differ and have one."""
    colors = [METHOD_COLORS.get(label.split()[0]) for label in labels]
    if None in colors or len(set(colors)) < len(colors):
        return [f"C{i}" for i in range(len(labels))]
    return [color for color in colors if color]


def _plot_emd(axis: Any, series: Series, color: str) -> None:
    y = np.array([result.emd for result in series.results])
    low, high = np.array([(r.low, r.high) for r in series.results], float).T  # NaN: no bar
    # a percentile interval need not hold the mean
    bars = np.maximum([y - low, high - y], 0)
    axis.errorbar(series.x, y, bars, marker="o", capsize=3, color=color, label=series.label)


def _plot_cost(axis: Any, series: Series, quantity: str, trend: Trend | None, color: str) -> None:
    known = [(x, getattr(r, quantity)) for x, r in zip(series.x, series.results, strict=True)]
    pairs = [(x, y) for x, y in known if y is not None]
    if not pairs:
        return
    axis.plot([x for x, _ in pairs], [y for _, y in pairs], "o" if trend else "o-", color=color)
    if trend:
        x = np.array([x for x in series.x if x > 0])
        label = f"{series.label}: exponent {trend.law.exponent:z.2f} ± {trend.law.error:.2f}"
        axis.plot(x, trend.law.factor * x**trend.law.exponent, "--", color=color, label=label)


def _set_y_axis(axis: Any, name: str) -> None:
    """From 0 or logarithmic, with room for the legend above the data."""
    axis.set_ylabel(name)
    values = [float(y) for line in axis.lines for y in line.get_ydata()]
    legend_share = min(
        MARGIN + LEGEND_ROW * len(axis.get_legend_handles_labels()[1]), MAX_LEGEND_SHARE
    )
    if _needs_log_axis(values):
        height = (max(values) / min(values)) ** (1 / (1 - MARGIN - legend_share))
        _logarithmic(axis, "y")
        axis.set_ylim(min(values) / height**MARGIN, max(values) * height**legend_share)
    elif values:
        axis.set_ylim(0, max(values) / (1 - legend_share))


def _logarithmic(axis: Any, which: str) -> None:
    """Ticks at 1, 2, 5, 10, 20: always some, and their labels do not overlap."""
    from matplotlib.ticker import LogLocator, NullFormatter

    axis.set(**{f"{which}scale": "log"})
    ticks = getattr(axis, f"{which}axis")
    ticks.set_major_locator(LogLocator(subs=(1, 2, 5)))
    ticks.set_major_formatter("{x:g}")
    ticks.set_minor_formatter(NullFormatter())


def _needs_log_axis(values: Sequence[float | int]) -> bool:
    """Whether `values` span enough for a logarithmic axis."""
    return bool(values) and min(values) > 0 and max(values) > LINEAR_SPAN * min(values)


def _price_quantity(series_list: list[Series], key: str) -> str:
    """`num_parameters` where a setting of a method changes it, else `seconds`."""
    counts = [[result.num_parameters for result in series.results] for series in series_list]
    is_varied = any(len(set(group)) > 1 for group in counts)
    all_known = all(number for group in counts for number in group)
    return (
        "num_parameters" if key.startswith(METHOD_PREFIX) and is_varied and all_known else "seconds"
    )


def _plot_tradeoff(
    axis: Any, series_list: list[Series], colors: Sequence[str], quantity: str
) -> None:
    """EMD against seconds or parameters, a line per series."""
    for series, color in zip(series_list, colors, strict=True):
        known = _tradeoff_points(series, quantity)
        axis.plot(
            [prices for prices, _, _ in known], [emd for _, emd, _ in known], "o-", color=color
        )
    axis.set(xlabel=AXIS_LABELS[quantity], ylabel="EMD (even), diagonals")
    axis.margins(0.1)  # room for labels
    axis.set_ylim(
        0, HEADROOM * max(result.emd for series in series_list for result in series.results)
    )
    prices = [getattr(result, quantity) for series in series_list for result in series.results]
    if _needs_log_axis([price_value for price_value in prices if price_value]):
        _logarithmic(axis, "x")


def _tradeoff_points(series: Series, quantity: str) -> list[tuple[float, float, str]]:
    """Cost, EMD and label of each point whose cost is known."""
    return [
        (float(getattr(result, quantity)), result.emd, f"{x:g}" if series.is_numeric else x)
        for x, result in zip(series.x, series.results, strict=True)
        if getattr(result, quantity) is not None
    ]


def _plot_front(axis: Any, series: Series, quantity: str) -> None:
    """The Pareto front as a black line."""
    prices = [(getattr(result, quantity), result.emd) for result in series.results]
    frontier = pareto_front(
        [(float(price_value), emd) for price_value, emd in prices if price_value is not None]
    )
    if frontier:
        label = f"no point is {CHEAPER_WORDS[quantity]} and better"
        axis.step(*zip(*frontier, strict=True), "o-", where="post", color=FRONT_COLOR, label=label)
        axis.legend(fontsize="small")


def _set_x_axis(axis: Any, series_list: list[Series], key: str) -> None:
    axis.set_xlabel("faces of the part" if key == SELECT_KEY else key)
    if not all(series.is_numeric for series in series_list):
        axis.tick_params(axis="x", labelrotation=20)
        return
    x = [each for series in series_list for each in series.x]
    if _needs_log_axis(x):
        axis.set_xscale("log")
        axis.set_xticks(sorted(set(x)), [f"{each:g}" for each in sorted(set(x))])
        axis.minorticks_off()
