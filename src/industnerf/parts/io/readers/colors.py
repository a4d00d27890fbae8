"""From colors as files state them to at most 256 finishes.

`srgb` is in [0, 1] and encoded for screens (IEC 61966-2-1), as STEP, IGES, MTL, PLY, OFF, 3MF,
COLLADA and all pictures have it; `srgb_to_linear` decodes it.  Finishes keep colors to 8 bits of
sRGB.  All are plain paint: shine stated by these formats is ignored.  A texture becomes one color
a face.
"""

import io

import numpy as np
from jaxtyping import Float, Float64, UInt8
from PIL import Image

from industnerf.artifacts.part import UNSPECIFIED, Appearance
from industnerf.parts.io.readers.mesh_content import MeshBody

MAX_FINISHES = 256  # finishes of one part: the mesh counts them in a byte
ROUGHNESS = 0.5  # of paint
TEXTURE_REDUCED = "pictures on the surface reduced to one color a face"
TEXTURE_UNREADABLE = "a picture on the surface is missing or cannot be read"


def srgb_to_linear(srgb: Float64[np.ndarray, "*n 3"]) -> Float64[np.ndarray, "*n 3"]:
    """The share of light that a surface of this color sends back."""
    srgb = np.clip(srgb, 0.0, 1.0)
    return np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)


def linear_to_srgb8(albedo: Float64[np.ndarray, "*n 3"]) -> UInt8[np.ndarray, "*n 3"]:
    """The inverse of `srgb_to_linear`, in 8 bits."""
    albedo = np.clip(albedo, 0.0, 1.0)
    srgb = np.where(albedo <= 0.0031308, 12.92 * albedo, 1.055 * albedo ** (1 / 2.4) - 0.055)
    return np.round(255 * srgb).astype(np.uint8)


def parse_hex(text: str) -> Float64[np.ndarray, "3"] | None:
    """The albedo of `#rrggbb` or `#rrggbbaa`; None if `text` is neither."""
    try:
        return srgb_to_linear(
            np.array(list(bytes.fromhex(text.strip()[1:7])), np.float64).reshape(3) / 255
        )
    except ValueError:
        return None


def quantize_finishes(
    bodies: tuple[MeshBody, ...],
) -> tuple[tuple[Appearance, ...], list[UInt8[np.ndarray, "m"]], tuple[str, ...]]:
    """The finishes of a file, which of them each face of each body has, and what was lost."""
    albedo = np.concatenate([body.albedo for body in bodies])
    is_stated = np.isfinite(albedo).all(axis=1)
    colors, palette_index, warnings = _reduce_palette(
        linear_to_srgb8(albedo[is_stated]), MAX_FINISHES - (not is_stated.all())
    )
    finish = np.zeros(len(albedo), np.uint8)
    finish[is_stated] = palette_index + (not is_stated.all())
    finishes = tuple(_finish(color) for color in colors)
    if not is_stated.all():
        finishes = (UNSPECIFIED, *finishes)
    ends = np.cumsum([len(body.faces) for body in bodies])[:-1]
    return finishes, np.split(finish, ends), warnings


def _reduce_palette(
    colors: UInt8[np.ndarray, "m 3"], max_colors: int
) -> tuple[UInt8[np.ndarray, "k 3"], np.ndarray, tuple[str, ...]]:
    """At most `max_colors` colors, the one of each row of `colors`, and a warning."""
    distinct, palette_index = np.unique(colors, axis=0, return_inverse=True)
    if len(distinct) <= max_colors:
        return distinct, palette_index.ravel(), ()
    image = Image.fromarray(np.ascontiguousarray(distinct[None]), "RGB")
    quantized = image.quantize(max_colors, Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
    table = np.array(quantized.getpalette(), np.uint8).reshape(-1, 3)
    indices = np.asarray(quantized).ravel()[palette_index.ravel()]
    used, palette_index = np.unique(indices, return_inverse=True)
    max_error = int(np.abs(table[indices].astype(int) - colors).max())
    warning = f"{len(distinct)} colors reduced to {len(used)}, at most {max_error} of 255 off"
    return table[used], palette_index.ravel(), (warning,)


def _finish(color: UInt8[np.ndarray, "3"]) -> Appearance:
    r, g, b = (round(float(x), 6) for x in srgb_to_linear(color / 255))
    return Appearance("#" + bytes(color).hex(), (r, g, b), 0.0, ROUGHNESS)


def sample_texture(
    data: bytes, corners: Float[np.ndarray, "m 3 2"]
) -> Float64[np.ndarray, "m 3"] | None:
    """The albedo at the middle of each face; None if `data` is no picture that can be read.

    `corners` are texture coordinates, v upwards; beyond [0, 1] the picture repeats.
    """
    try:
        with Image.open(io.BytesIO(data)) as image:
            pixels = np.asarray(image.convert("RGB"))
    except (OSError, ValueError, SyntaxError, Image.DecompressionBombError):
        return None
    height, width, _ = pixels.shape
    uv = np.nan_to_num(corners.mean(axis=1), posinf=0.0, neginf=0.0)
    column = (np.mod(uv[:, 0], 1.0) * width).astype(int).clip(0, width - 1)
    row = (np.mod(1 - uv[:, 1], 1.0) * height).astype(int).clip(0, height - 1)
    return srgb_to_linear(pixels[row, column].astype(np.float64) / 255)
