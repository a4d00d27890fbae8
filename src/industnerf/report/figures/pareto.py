"""All methods at a glance: EMD against seconds, which differ from run to run."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from industnerf.methods.base import Role, Scope
from industnerf.report.figures.figure_style import encode_png, new_figure
from industnerf.report.results import Results
from industnerf.report.tables.table1 import Table1Row
from industnerf.report.tables.table1_format import Table1Extra

# Where a text may stand beside its point: points right and up, and which of its ends is there.
LABEL_OFFSETS = [
    (across, up, side)
    for up in (4, -10, 12, -18, 20, -26)
    for across, side in ((5, "left"), (-5, "right"))
]
DOT_RADIUS = 4  # points from the middle of a dot to its rim, with some air


@dataclass(frozen=True)
class MethodGroup:
    """Methods that are drawn alike."""

    label: str
    color: str
    is_competitor: bool  # may be on the front; its dot is filled


PART_GROUP = MethodGroup("from photographs of the part alone", "#30638e", True)
DATASET_GROUP = MethodGroup("learns from other parts", "#c8691c", True)
REFERENCE_GROUP = MethodGroup("bounds and nulls", "#6e7781", False)
FRONT_COLOR = "#d1495b"


def plot_pareto(results: Results) -> bytes:
    """A PNG of EMD over its floor against seconds per part, with the Pareto front.

    Large dots are the means of Table 1, small ones the parts.
    Rows of another split than the first, and methods whose seconds the store does not know, are
    left out. Bounds and nulls are hollow and not on the front.
    """
    rows, extras = results.table1, results.table1_extras
    means = [
        (extra.seconds, row.ratio_to_floor, row.method, _group(row, extra))
        for row, extra in zip(rows, extras, strict=True)
        if extra.seconds and row.split == rows[0].split
    ]
    from matplotlib.ticker import LogLocator, NullLocator

    figure = new_figure(8.4, 5.4)
    axis = figure.subplots()
    kind = "wall" if any(extra.is_wall_time for extra in extras) else "processor"
    axis.set(xlabel=f"{kind} seconds a part, reconstruction alone", ylabel="EMD (even) / floor")
    if means:
        axis.set(xscale="log", yscale="log")
        axis.yaxis.set_major_locator(LogLocator(10, subs=(1, 2, 5)))
        axis.yaxis.set_minor_locator(NullLocator())
        axis.yaxis.set_major_formatter("{x:g}")
        axis.xaxis.set_major_formatter("{x:g}")
    else:
        axis.text(0.5, 0.5, "the store, which knows the seconds, is not at hand", ha="center")
    for seconds, ratio, method, group in means:
        fill = group.color if group.is_competitor else "white"
        axis.plot(seconds, ratio, "o", ms=7, color=group.color, mfc=fill, zorder=3)
        if dots := results.part_points.get(method):
            axis.plot(*zip(*dots, strict=True), ".", ms=3, color=group.color, alpha=0.3, zorder=1)
    frontier = pareto_front([(x, y) for x, y, _, group in means if group.is_competitor])
    if frontier:
        axis.step(*zip(*frontier, strict=True), where="post", color=FRONT_COLOR, lw=1, zorder=2)
    for group in dict.fromkeys(group for *_, group in means):
        fill = group.color if group.is_competitor else "white"
        axis.plot([], [], "o", ms=7, color=group.color, mfc=fill, label=group.label)
    axis.grid(color="#eaeef2")
    axis.set_axisbelow(True)
    axis.spines[["top", "right"]].set_visible(False)
    if means:
        axis.plot([], [], ".", ms=3, color=REFERENCE_GROUP.color, label="one part")
        figure.legend(loc="outside upper center", ncols=4, frameon=False, fontsize=8)
    label_points(axis, [(x, y, method, "black") for x, y, method, _ in means], 8)
    return encode_png(figure)


def _group(row: Table1Row, extra: Table1Extra) -> MethodGroup:
    if extra.role != Role.METHOD:
        return REFERENCE_GROUP
    return PART_GROUP if row.scope == Scope.PART else DATASET_GROUP


def label_points(
    axis: Any, points: Sequence[tuple[float, float, str, str]], font_size: int
) -> None:
    """Write beside each point (x, y, text, color) its text, where it hides no dot or text.

    A point without such a place within the axes gets no text. Call it last: what comes after may
    move the points.
    """
    from matplotlib.patheffects import withStroke
    from matplotlib.transforms import Bbox

    # the halo: a text may cross a line of its color
    halo = withStroke(linewidth=2, foreground="white")
    style = {"fontsize": font_size, "path_effects": [halo], "textcoords": "offset points"}
    figure = axis.get_figure(root=True)
    figure.draw_without_rendering()
    dot_radius_px = DOT_RADIUS * figure.dpi / 72
    dots = axis.transData.transform([(x, y) for x, y, *_ in points]) if points else []
    occupied = [Bbox([dot - dot_radius_px, dot + dot_radius_px]) for dot in dots]
    for x, y, text, color in points:
        for dx, dy, alignment in LABEL_OFFSETS:
            label = axis.annotate(text, (x, y), (dx, dy), ha=alignment, color=color, **style)
            box = label.get_window_extent()
            inside = all(axis.bbox.contains(*corner) for corner in (box.min, box.max))
            if inside and not box.count_overlaps(occupied):
                occupied.append(box)
                break
            label.remove()


def pareto_front(points: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """The points that no other is at or below in both coordinates, from left to right."""
    frontier: list[tuple[float, float]] = []
    for point in sorted(set(points)):
        if not frontier or point[1] < frontier[-1][1]:
            frontier.append(point)
    return frontier
