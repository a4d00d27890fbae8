"""Pictures small enough to be kept under version control."""

import io

from PIL import Image

WIDTHS = (2200, 1800, 1500, 1200, 1000, 800)  # px that are tried, widest first
COLORS = 256


def downsample_png(png: bytes, budget: int) -> bytes:
    """`png` with a palette and as wide as `budget` bytes allow; never wider than it is.

    If even the narrowest is larger than that, it is returned all the same.
    """
    reduced = png
    for width in WIDTHS:
        reduced = _resize_with_palette(png, width)
        if len(reduced) <= budget:
            break
    return reduced


def _resize_with_palette(png: bytes, width: int) -> bytes:
    with Image.open(io.BytesIO(png)) as image:
        rgb = image.convert("RGB")
    rgb.thumbnail((width, rgb.height), Image.Resampling.LANCZOS)
    out = io.BytesIO()
    # Of Pillow's choices of a palette the nearest to the picture, and among the smallest files;
    # without dithering, which no PNG can compress.
    paletted = rgb.quantize(COLORS, Image.Quantize.MAXCOVERAGE, kmeans=3, dither=Image.Dither.NONE)
    paletted.save(out, "PNG", optimize=True)
    return out.getvalue()
