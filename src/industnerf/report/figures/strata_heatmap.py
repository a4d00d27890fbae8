"""Where each method fails: EMD over its floor by stratum of the parts."""

from collections.abc import Sequence

import numpy as np

from industnerf.report.figures.figure_style import encode_png, new_figure
from industnerf.report.tables.strata import ALL, StratumRow

WORST_RATIO = 20.0  # of the color scale, which is logarithmic
DARK = 0.55  # of the color scale: text on it is white
CELL_INCHES = (1.15, 0.3)


def plot_strata(rows: Sequence[StratumRow]) -> bytes | None:
    """A PNG: a row per method, the best first, a column per stratum; None without rows.

    A cell says EMD (even) over its floor, both means over the parts of the stratum. It is empty
    where none of them could be scored.
    """
    if not rows:
        return None
    methods = [row.method for row in rows if row.stratum == ALL]
    sizes = {row.stratum: row.parts for row in rows}
    ratios = {(row.method, row.stratum): row.ratio_to_floor for row in rows}
    grid = np.array([[ratios.get((method, name), np.nan) for name in sizes] for method in methods])
    shade = np.log(grid) / np.log(WORST_RATIO)
    width, height = CELL_INCHES
    figure = new_figure(1.6 + width * len(sizes), 0.7 + height * len(methods))
    axis = figure.subplots()
    axis.imshow(shade, cmap="YlOrRd", vmin=0, vmax=1, aspect="auto")
    for (i, j), ratio in np.ndenumerate(grid):
        if np.isfinite(ratio):
            color = "white" if shade[i, j] > DARK else "black"
            axis.text(j, i, f"{ratio:.2f}", ha="center", va="center", color=color, fontsize=8)
    axis.set_xticks(range(len(sizes)), [f"{name}\n{parts} parts" for name, parts in sizes.items()])
    axis.set_yticks(range(len(methods)), methods)
    axis.xaxis.tick_top()
    axis.tick_params(length=0, labelsize=8)
    axis.set_xlabel("EMD (even) / floor: 1 is a second sample of the true surface", fontsize=8)
    axis.spines[:].set_visible(False)
    return encode_png(figure)
