"""One photograph as 8-bit color."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float, UInt8
from PIL import Image, ImageOps

from industnerf.errors import BadArtifact

EXIF_ORIENTATION, ROTATED_ORIENTATIONS = (
    0x0112,
    range(2, 9),
)  # the EXIF tag; 1 is upright, 0 unknown
MODES_16BIT = ("I;16", "I;16L", "I;16B", "I;16N")
MODES_8BIT = ("1", "L", "P", "RGB", "CMYK", "YCbCr")


@dataclass(frozen=True)
class ImageInfo:
    """What a photograph was, and what had to be decided to read it."""

    size: tuple[int, int]  # (width, height) in px, upright
    has_transparency: bool  # at least in one pixel, which now shows the background
    is_rotated: bool  # its EXIF orientation was applied


def read_image(
    path: Path,
    background: Float[np.ndarray, "3"],
    camera_size: tuple[int, int] | None,
    frame_label: str,
) -> tuple[UInt8[np.ndarray, "h w 3"], ImageInfo]:
    """Read `path`; what is see-through shows `background` (sRGB in [0, 1]).

    `stated` is the (width, height) of its camera.  Raises BadArtifact that names the file and
    the frame `where` if it is no image, is torn, or holds pixels of an unknown kind.
    """
    try:
        with Image.open(path) as image:
            image.load()
            upright, is_rotated = _apply_exif_orientation(image, camera_size, path, frame_label)
            rgb, has_transparency = _to_rgb(upright, background, path, frame_label)
            return rgb, ImageInfo(upright.size, has_transparency, is_rotated)
    except (OSError, SyntaxError, ValueError, Image.DecompressionBombError) as error:
        raise BadArtifact(f"{frame_label}: {path} cannot be read as an image: {error}") from None


def _apply_exif_orientation(
    image: Image.Image, camera_size: tuple[int, int] | None, path: Path, frame_label: str
) -> tuple[Image.Image, bool]:
    """The image with its EXIF orientation applied, if that is what the camera speaks of.

    Some tools turn photographs before they find the cameras and some do not.  The camera's size
    tells which; where it does not (square, upside down, unstated), a guess would fail silently.
    """
    if image.getexif().get(EXIF_ORIENTATION) not in ROTATED_ORIENTATIONS:
        return image, False
    upright = ImageOps.exif_transpose(image)
    if camera_size is not None and upright.size != image.size:
        if is_same_aspect(image.size, camera_size):
            return image, False
        if is_same_aspect(upright.size, camera_size):
            return upright, True
    raise BadArtifact(
        f"{frame_label}: {path} has an EXIF orientation, and its camera does not tell whether it "
        "belongs to the pixels before or after that turn; turn the pixels and drop the tag"
    )


def is_same_aspect(size: tuple[int, int], reference: tuple[int, int]) -> bool:
    """Whether an image of `size` is a scaled copy of one of `stated` px, rounded to pixels.

    Equal in one length and not in the other is a crop, however little is gone.
    """
    if (size[0] == reference[0]) != (size[1] == reference[1]):
        return False
    return abs(size[0] * reference[1] - size[1] * reference[0]) <= max(reference)


def _to_rgb(
    image: Image.Image, background: Float[np.ndarray, "3"], path: Path, frame_label: str
) -> tuple[UInt8[np.ndarray, "h w 3"], bool]:
    if image.mode in ("RGBA", "LA", "PA") or "transparency" in image.info:
        rgba = np.asarray(image.convert("RGBA"), np.float32)
        alpha = rgba[..., 3:] / 255
        composited = rgba[..., :3] * alpha + (1 - alpha) * (255 * background.astype(np.float32))
        return np.rint(composited).astype(np.uint8), bool((alpha < 1).any())
    if image.mode in MODES_16BIT:
        gray = np.rint(np.asarray(image).astype(np.float32) / 257).astype(np.uint8)
        return np.repeat(gray[..., None], 3, axis=2), False
    if image.mode in MODES_8BIT:
        return np.asarray(image.convert("RGB")), False
    raise BadArtifact(
        f"{frame_label}: {path} holds pixels of kind {image.mode!r}; save it with 8 or 16 bits a channel"
    )
