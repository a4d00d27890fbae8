"""PNG images between stages, and the error of one that cannot be read."""

import io
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


def encode_png(pixels: np.ndarray) -> bytes:
    """8- or 16-bit gray, 8-bit color, or truth values as a PNG."""
    png = io.BytesIO()
    # Of a part's views, level 2 writes a megabyte more than 6, in half the time or less.
    Image.fromarray(pixels).save(png, "png", compress_level=2)
    return png.getvalue()


def decode_png(png: bytes, path: Path, height: int, width: int, stage: str) -> np.ndarray:
    """The pixels of `png`, which `path` holds; raises BadArtifact if torn or of another size."""
    try:
        with Image.open(io.BytesIO(png)) as image:
            pixels = np.asarray(image)
    except (OSError, SyntaxError, ValueError) as error:  # pillow raises all three
        raise corrupt_error(path, f"cannot be read ({error})", stage) from None
    if pixels.shape[:2] != (height, width):
        what = f"has {pixels.shape[:2]} rows and columns, not {(height, width)}"
        raise corrupt_error(path, what, stage)
    return pixels
