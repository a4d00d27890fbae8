"""What a method costs against how good it is: a PNG of its own, for seconds differ between runs."""

import io
from collections.abc import Sequence

from industnerf.methods.base import Role
from industnerf.report.table1 import Row
from industnerf.report.table1_text import Extra


def pareto(rows: Sequence[Row], extras: Sequence[Extra]) -> bytes:
    """A PNG: EMD (even) against seconds a part, and the methods that none is better than at both.

    Rows of another split than the first, and methods whose seconds the store does not know, are
    left out; bounds and nulls are hollow, and no part of the front.
    """
    from matplotlib.figure import Figure

    known = [
        (extra.seconds, row.emd_even, row.method, extra.role == Role.METHOD)
        for row, extra in zip(rows, extras, strict=True)
        if extra.seconds and row.split == rows[0].split
    ]
    figure = Figure(figsize=(7.2, 4.6), layout="constrained")
    axis = figure.subplots()
    axis.set(xlabel="seconds a part, reconstruction alone", ylabel="EMD (even), diagonals")
    if known:
        axis.set(xscale="log", yscale="log")
    else:
        axis.text(0.5, 0.5, "the store, which knows the seconds, is not at hand", ha="center")
    for seconds, emd, method, rival in known:
        axis.plot(seconds, emd, "o", color="#30638e", mfc="#30638e" if rival else "white")
        axis.annotate(method, (seconds, emd), (5, 4), textcoords="offset points", fontsize=8)
    best = front([(seconds, emd) for seconds, emd, _, rival in known if rival])
    if best:
        axis.step(*zip(*best, strict=True), where="post", color="#d1495b", lw=1, zorder=0)
    axis.grid(color="#eaeef2")
    axis.set_axisbelow(True)
    axis.spines[["top", "right"]].set_visible(False)
    png = io.BytesIO()
    figure.savefig(png, dpi=130, metadata={"Software": None})
    return png.getvalue()


def front(points: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """The points that no other is at or below in both coordinates, from left to right."""
    best: list[tuple[float, float]] = []
    for point in sorted(set(points)):
        if not best or point[1] < best[-1][1]:
            best.append(point)
    return best
