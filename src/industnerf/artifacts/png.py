"""PNG images between stages, and the error of one that cannot be read."""

from pathlib import Path

import numpy as np
from jaxtyping import Float, UInt16
from PIL import Image

from industnerf.artifacts.files import corrupt_error

MAX_DEPTH_VALUE = 65535  # largest value of a 16-bit pixel


def quantize_depth(
    depth_mm: Float[np.ndarray, "*pixels"], step_mm: float
) -> UInt16[np.ndarray, "*pixels"]:
    """Depth as 16-bit pixels: 0 is background, so what is nearer than a step is 1."""
    return np.maximum(np.rint(depth_mm / step_mm), depth_mm > 0).astype(np.uint16)


def write_png(path: Path, pixels: np.ndarray) -> None:
    """Write 8- or 16-bit gray, 8-bit color, or truth values."""
    # Of a part's views, level 2 writes a megabyte more than 6, in half the time or less.
    Image.fromarray(pixels).save(path, compress_level=2)


def read_png(path: Path, height: int, width: int, stage: str) -> np.ndarray:
    """The pixels in `path`; raises BadArtifact if it is missing, torn or of another size."""
    try:
        with Image.open(path) as image:
            pixels = np.asarray(image)
    except (OSError, SyntaxError, ValueError) as error:  # pillow raises all three
        raise corrupt_error(path, f"cannot be read ({error})", stage) from None
    if pixels.shape[:2] != (height, width):
        what = f"has {pixels.shape[:2]} rows and columns, not {(height, width)}"
        raise corrupt_error(path, what, stage)
    return pixels
