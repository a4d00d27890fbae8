"""Figures of the documents: axes, images on them, color bars, a small PNG."""

import io
from typing import Any

import numpy as np
from jaxtyping import Float, UInt8
from PIL import Image

DPI = 100
WHITE_LEVEL = 248  # of 255: what is as bright in all channels is white paper


def new_figure(width: float | int, height: float | int) -> Any:
    """An empty figure, sizes in inches, that places its axes by itself."""
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained")


def show_image(axis: Any, pixels: np.ndarray, title: str = "", **image_options: Any) -> Any:
    """Show `pixels` on `axis`, without a frame, and return the image."""
    axis.set(xticks=[], yticks=[], frame_on=False)
    axis.set_title(title, fontsize=8)
    return axis.imshow(pixels, **image_options)


def colorize(
    values: Float[np.ndarray, "*n"], color_map: str, max_value: float
) -> UInt8[np.ndarray, "*n 3"]:
    """The colors of `values`: 0 has the first of `color_map`, `max_value` the last."""
    from matplotlib import colormaps

    return colormaps[color_map](np.clip(values / max_value, 0, 1), bytes=True)[..., :3]


def add_colorbar(figure: Any, axes: Any, color_map: str, max_value: float, label: str) -> None:
    """Draw a color bar from 0 to `max_value` beside `axes`."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    mappable = ScalarMappable(Normalize(0, max_value), color_map)
    bar = figure.colorbar(mappable, ax=axes, shrink=0.85, pad=0.01, fraction=0.05)
    bar.set_label(label, fontsize=7)
    bar.ax.tick_params(labelsize=6)


def encode_png(figure: Any) -> bytes:
    """The figure as a PNG of 256 colors: a third of the bytes, for it stands in the repository."""
    full_png, small_png = io.BytesIO(), io.BytesIO()
    figure.savefig(full_png, dpi=DPI, metadata={"Software": None})
    image = Image.open(full_png).convert("RGB")
    # by coverage, for the colors of a legend are few pixels, and have to stay
    palette = image.quantize(256, Image.Quantize.MAXCOVERAGE)
    colors = np.array(palette.getpalette()).reshape(-1, 3)
    colors[colors.min(axis=1) >= WHITE_LEVEL] = 255  # not a mean of whites: it is most of a figure
    palette.putpalette(colors.ravel().tolist())
    image.quantize(palette=palette).save(small_png, "png", optimize=True)
    return small_png.getvalue()
