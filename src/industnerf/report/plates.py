"""Figures that stand in the documents: a few axes, pictures on them, a small PNG."""

import io
from typing import Any

import numpy as np
from jaxtyping import Float, UInt8
from PIL import Image

INCH = 100  # px
WHITE = 248  # of 255: what is as bright in all channels is white paper


def figure(wide: float | int, high: float | int) -> Any:
    """An empty figure of so many inches that places its axes by itself."""
    from matplotlib.figure import Figure

    return Figure(figsize=(wide, high), layout="constrained")


def picture(axis: Any, pixels: np.ndarray, title: str = "", **how: Any) -> Any:
    """`pixels` on `axis`, without a frame."""
    axis.set(xticks=[], yticks=[], frame_on=False)
    axis.set_title(title, fontsize=8)
    return axis.imshow(pixels, **how)


def tinted(
    values: Float[np.ndarray, "*n"], colour_map: str, highest: float
) -> UInt8[np.ndarray, "*n 3"]:
    """The colours of `values`, of which 0 has the first and `highest` the last."""
    from matplotlib import colormaps

    return colormaps[colour_map](np.clip(values / highest, 0, 1), bytes=True)[..., :3]


def legend(figure: Any, axes: Any, colour_map: str, highest: float, label: str) -> None:
    """What the colours from 0 to `highest` mean, beside `axes`."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    colours = ScalarMappable(Normalize(0, highest), colour_map)
    bar = figure.colorbar(colours, ax=axes, shrink=0.85, pad=0.01, fraction=0.05)
    bar.set_label(label, fontsize=7)
    bar.ax.tick_params(labelsize=6)


def png(figure: Any) -> bytes:
    """The figure as a PNG of 256 colours: a third of the bytes, for it stands in the repository."""
    drawn, small = io.BytesIO(), io.BytesIO()
    figure.savefig(drawn, dpi=INCH, metadata={"Software": None})
    whole = Image.open(drawn).convert("RGB")
    # by coverage, for the colours of a legend are few pixels, and have to stay
    palette = whole.quantize(256, Image.Quantize.MAXCOVERAGE)
    colours = np.array(palette.getpalette()).reshape(-1, 3)
    colours[colours.min(axis=1) >= WHITE] = 255  # not a mean of whites: it is most of a plate
    palette.putpalette(colours.ravel().tolist())
    whole.quantize(palette=palette).save(small, "png", optimize=True)
    return small.getvalue()
