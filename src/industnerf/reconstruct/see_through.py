"""Which color to show where photographs are see-through, or masked."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float, UInt8

from industnerf.reconstruct.images import View

# White first: what is gray or dark, as most parts, differs from it.
CANDIDATES = np.array(
    [
        [1.0, 1.0, 1.0],
        [0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [1.0, 0.0, 1.0],
        [0.0, 0.0, 1.0],
        [0.0, 1.0, 1.0],
        [1.0, 1.0, 0.0],
        [1.0, 0.0, 0.0],
    ]
)
MIN_DIFFERENCE = 0.04  # in [0, 1]: twice what a method takes for the background's own color
MAX_SIMILAR_SHARE = 0.002  # of the part's pixels; more would be holes in its outline
OPAQUE = 250  # of 255
MAX_PIXELS = 4096  # of each view that are looked at


def choose_background(views: Sequence[View]) -> Float[np.ndarray, "3"]:
    """The first of CANDIDATES that all but MAX_SIMILAR_SHARE of the part's pixels differ from.

    If there is none, the one that most differ from.  sRGB in [0, 1].
    """
    samples = [_part_colors(view) for view in views if view.pixels.shape[2] == 4]
    colors = np.concatenate(samples or [np.zeros((0, 3), np.uint8)]) / 255
    if not len(colors):
        return CANDIDATES[0]
    similar = [
        float((np.abs(colors - candidate).max(axis=1) < MIN_DIFFERENCE).mean())
        for candidate in CANDIDATES
    ]
    fine = [index for index, share in enumerate(similar) if share <= MAX_SIMILAR_SHARE]
    return CANDIDATES[fine[0] if fine else int(np.argmin(similar))]


def _part_colors(view: View) -> UInt8[np.ndarray, "n 3"]:
    pixels = view.pixels.reshape(-1, 4)
    opaque = pixels[pixels[:, 3] >= OPAQUE, :3]
    return opaque[:: 1 + len(opaque) // MAX_PIXELS]


def shows_nothing(view: View) -> bool:
    """Whether a mask or alpha leaves nothing of the photograph."""
    return view.pixels.shape[2] == 4 and int(view.pixels[..., 3].max()) < 128


def covers_border(view: View) -> bool:
    """Whether a mask keeps most of the border: then it is no outline of a part."""
    if not view.info.has_mask or view.pixels.shape[2] == 3:
        return view.info.has_mask
    alpha = view.pixels[..., 3]
    edges = np.concatenate([alpha[0], alpha[-1], alpha[1:-1, 0], alpha[1:-1, -1]])
    return bool((edges >= OPAQUE).mean() > 0.5)
