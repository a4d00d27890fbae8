"""Pictures small enough to be kept under version control."""

import io

from PIL import Image

WIDTHS = (2200, 1800, 1500, 1200, 1000, 800)  # px that are tried, widest first
COLOURS = 256


def shrunk(png: bytes, budget: int) -> bytes:
    """`png` with a palette and as wide as `budget` bytes allow; never wider than it is.

    If even the narrowest is larger than that, it is returned all the same.
    """
    small = png
    for width in WIDTHS:
        small = _palette(png, width)
        if len(small) <= budget:
            break
    return small


def _palette(png: bytes, width: int) -> bytes:
    with Image.open(io.BytesIO(png)) as picture:
        rgb = picture.convert("RGB")
    rgb.thumbnail((width, rgb.height), Image.Resampling.LANCZOS)
    out = io.BytesIO()
    # Of Pillow's choices of a palette the nearest to the picture, and among the smallest files;
    # without dithering, which no PNG can compress.
    few = rgb.quantize(COLOURS, Image.Quantize.MAXCOVERAGE, kmeans=3, dither=Image.Dither.NONE)
    few.save(out, "PNG", optimize=True)
    return out.getvalue()
