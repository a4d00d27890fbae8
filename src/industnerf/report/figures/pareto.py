"""EMD against seconds: a PNG of its own, because seconds differ between runs."""

import io
from collections.abc import Sequence
from typing import Any

from industnerf.methods.base import Role
from industnerf.report.tables.table1 import Table1Row
from industnerf.report.tables.table1_format import Table1Extra

# Where a text may stand beside its point: points right and up, and which of its ends is there.
LABEL_OFFSETS = [
    (across, up, side)
    for up in (4, -10, 12, -18, 20, -26)
    for across, side in ((5, "left"), (-5, "right"))
]
DOT_RADIUS = 4  # points from the middle of a dot to its rim, with some air


def plot_pareto(rows: Sequence[Table1Row], extras: Sequence[Table1Extra]) -> bytes:
    """A PNG of EMD (even) against seconds per part, with the Pareto front.

    Rows of another split than the first, and methods whose seconds the store does not know, are
    left out. Bounds and nulls are hollow and not on the front.
    """
    from matplotlib.figure import Figure

    points = [
        (extra.seconds, row.emd_even, row.method, extra.role == Role.METHOD)
        for row, extra in zip(rows, extras, strict=True)
        if extra.seconds and row.split == rows[0].split
    ]
    figure = Figure(figsize=(7.2, 4.6), layout="constrained")
    axis = figure.subplots()
    kind = "wall" if any(extra.is_wall_time for extra in extras) else "processor"
    axis.set(xlabel=f"{kind} seconds a part, reconstruction alone", ylabel="EMD (even), diagonals")
    if points:
        axis.set(xscale="log", yscale="log")
    else:
        axis.text(0.5, 0.5, "the store, which knows the seconds, is not at hand", ha="center")
    for seconds, emd, _, is_competitor in points:
        axis.plot(seconds, emd, "o", color="#30638e", mfc="#30638e" if is_competitor else "white")
    frontier = pareto_front(
        [(seconds, emd) for seconds, emd, _, is_competitor in points if is_competitor]
    )
    if frontier:
        axis.step(*zip(*frontier, strict=True), where="post", color="#d1495b", lw=1, zorder=0)
    axis.grid(color="#eaeef2")
    axis.set_axisbelow(True)
    axis.spines[["top", "right"]].set_visible(False)
    label_points(axis, [(*point, "black") for *point, _ in points], 8)
    png = io.BytesIO()
    figure.savefig(png, dpi=130, metadata={"Software": None})
    return png.getvalue()


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
