"""From colours as files state them to at most 256 finishes.

What is called `srgb` is in [0, 1] and encoded for screens (IEC 61966-2-1), as STEP, IGES, MTL, PLY,
OFF, 3MF, COLLADA and all pictures have it; `linear` decodes it.  Finishes keep colours to 8 bits of
sRGB, and are plain paint: no file of these formats is believed about shine.
"""

import numpy as np
from jaxtyping import Float64, UInt8
from PIL import Image

from industnerf.artifacts.finish import UNSTATED, Finish
from industnerf.parts.reading.content import Body

MOST = 256  # finishes of one part: the mesh counts them in a byte
ROUGHNESS = 0.5  # of paint


def linear(srgb: Float64[np.ndarray, "*n 3"]) -> Float64[np.ndarray, "*n 3"]:
    """The share of light that a surface of this colour sends back."""
    srgb = np.clip(srgb, 0.0, 1.0)
    return np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)


def encoded(albedo: Float64[np.ndarray, "*n 3"]) -> UInt8[np.ndarray, "*n 3"]:
    """The inverse of `linear`, in 8 bits."""
    albedo = np.clip(albedo, 0.0, 1.0)
    srgb = np.where(albedo <= 0.0031308, 12.92 * albedo, 1.055 * albedo ** (1 / 2.4) - 0.055)
    return np.round(255 * srgb).astype(np.uint8)


def hex_colour(text: str) -> Float64[np.ndarray, "3"] | None:
    """The albedo of `#rrggbb` or `#rrggbbaa`; None if `text` is neither."""
    try:
        return linear(np.array(list(bytes.fromhex(text.strip()[1:7])), np.float64).reshape(3) / 255)
    except ValueError:
        return None


def finishes_of(
    bodies: tuple[Body, ...],
) -> tuple[tuple[Finish, ...], list[UInt8[np.ndarray, "m"]], tuple[str, ...]]:
    """The finishes of a file, which of them each face of each body has, and what was lost."""
    albedo = np.concatenate([body.albedo for body in bodies])
    stated = np.isfinite(albedo).all(axis=1)
    colours, which, remarks = _palette(encoded(albedo[stated]), MOST - (not stated.all()))
    finish = np.zeros(len(albedo), np.uint8)
    finish[stated] = which + (not stated.all())
    finishes = tuple(_finish(colour) for colour in colours)
    if not stated.all():
        finishes = (UNSTATED, *finishes)
    ends = np.cumsum([len(body.faces) for body in bodies])[:-1]
    return finishes, np.split(finish, ends), remarks


def _palette(
    colours: UInt8[np.ndarray, "m 3"], most: int
) -> tuple[UInt8[np.ndarray, "k 3"], np.ndarray, tuple[str, ...]]:
    """At most `most` colours, which of them stands for each row of `colours`, and a remark."""
    distinct, which = np.unique(colours, axis=0, return_inverse=True)
    if len(distinct) <= most:
        return distinct, which.ravel(), ()
    picture = Image.fromarray(np.ascontiguousarray(distinct[None]), "RGB")
    reduced = picture.quantize(most, Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
    table = np.array(reduced.getpalette(), np.uint8).reshape(-1, 3)
    indices = np.asarray(reduced).ravel()[which.ravel()]
    used, which = np.unique(indices, return_inverse=True)
    off = int(np.abs(table[indices].astype(int) - colours).max())
    remark = f"{len(distinct)} colours reduced to {len(used)}, at most {off} of 255 off"
    return table[used], which.ravel(), (remark,)


def _finish(colour: UInt8[np.ndarray, "3"]) -> Finish:
    r, g, b = (round(float(x), 6) for x in linear(colour / 255))
    return Finish("#" + bytes(colour).hex(), (r, g, b), 0.0, ROUGHNESS)
