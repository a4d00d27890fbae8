"""One photograph as 8-bit colour."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float, UInt8
from PIL import Image, ImageOps

from industnerf.errors import BadArtifact

ORIENTATION, TURNS = 0x0112, range(2, 9)  # the EXIF tag; 1 is upright, 0 unknown
SIXTEEN = ("I;16", "I;16L", "I;16B", "I;16N")
PLAIN = ("1", "L", "P", "RGB", "CMYK", "YCbCr")


@dataclass(frozen=True)
class Facts:
    """What a photograph was, and what had to be decided to read it."""

    size: tuple[int, int]  # (width, height) in px, upright
    see_through: bool  # at least in one pixel, which now shows the background
    turned: bool  # its EXIF orientation was applied


def read_photo(
    path: Path,
    background: Float[np.ndarray, "3"],
    stated: tuple[int, int] | None,
    where: str,
) -> tuple[UInt8[np.ndarray, "h w 3"], Facts]:
    """Read `path`; what is see-through shows `background` (sRGB in [0, 1]).

    `stated` is the (width, height) of its camera.  Raises BadArtifact that names the file and
    the frame `where` if it is no image, is torn, or holds pixels of an unknown kind.
    """
    try:
        with Image.open(path) as image:
            image.load()
            upright, turned = _upright(image, stated, path, where)
            rgb, see_through = _colour(upright, background, path, where)
            return rgb, Facts(upright.size, see_through, turned)
    except (OSError, SyntaxError, ValueError, Image.DecompressionBombError) as error:
        raise BadArtifact(f"{where}: {path} cannot be read as an image: {error}") from None


def _upright(
    image: Image.Image, stated: tuple[int, int] | None, path: Path, where: str
) -> tuple[Image.Image, bool]:
    """The image with its EXIF orientation applied, if that is what the camera speaks of.

    Some tools turn photographs before they find the cameras and some do not.  The camera's size
    tells which; where it does not (square, upside down, unstated), a guess would fail silently.
    """
    if image.getexif().get(ORIENTATION) not in TURNS:
        return image, False
    upright = ImageOps.exif_transpose(image)
    if stated is not None and upright.size != image.size:
        if same_shape(image.size, stated):
            return image, False
        if same_shape(upright.size, stated):
            return upright, True
    raise BadArtifact(
        f"{where}: {path} has an EXIF orientation, and its camera does not tell whether it "
        "belongs to the pixels before or after that turn; turn the pixels and drop the tag"
    )


def same_shape(size: tuple[int, int], stated: tuple[int, int]) -> bool:
    """Whether an image of `size` is a scaled copy of one of `stated` px, rounded to pixels.

    Equal in one length and not in the other is a crop, however little is gone.
    """
    if (size[0] == stated[0]) != (size[1] == stated[1]):
        return False
    return abs(size[0] * stated[1] - size[1] * stated[0]) <= max(stated)


def _colour(
    image: Image.Image, background: Float[np.ndarray, "3"], path: Path, where: str
) -> tuple[UInt8[np.ndarray, "h w 3"], bool]:
    if image.mode in ("RGBA", "LA", "PA") or "transparency" in image.info:
        rgba = np.asarray(image.convert("RGBA"), np.float32)
        alpha = rgba[..., 3:] / 255
        over = rgba[..., :3] * alpha + (1 - alpha) * (255 * background.astype(np.float32))
        return np.rint(over).astype(np.uint8), bool((alpha < 1).any())
    if image.mode in SIXTEEN:
        grey = np.rint(np.asarray(image).astype(np.float32) / 257).astype(np.uint8)
        return np.repeat(grey[..., None], 3, axis=2), False
    if image.mode in PLAIN:
        return np.asarray(image.convert("RGB")), False
    raise BadArtifact(
        f"{where}: {path} holds pixels of kind {image.mode!r}; save it with 8 or 16 bits a channel"
    )
