"""One photograph as 8-bit color, reduced and undistorted, with its camera."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float, Float32, UInt8
from PIL import Image, ImageOps
from scipy.sparse import csr_array

from industnerf.errors import BadArtifact
from industnerf.geometry.cameras import reduced_size
from industnerf.reconstruct.camera_models import (
    Distortion,
    image_size,
    intrinsics,
    parse_distortion,
    undistort,
)
from industnerf.reconstruct.transforms import Frame, parse_pose

EXIF_ORIENTATION, ROTATED_ORIENTATIONS = 0x0112, range(2, 9)  # the tag; 1 is upright, 0 unknown
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

    `camera_size` is the (width, height) that its camera states.  Raises BadArtifact that names the
    file and the frame if it is no image, is torn, or holds pixels of an unknown kind.
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
    """Whether an image of `size` is a scaled copy of one of `reference` px, rounded to pixels.

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
        f"{frame_label}: {path} holds pixels of kind {image.mode!r}; save it with 8 or 16 bits a "
        "channel"
    )


def resize_area(
    image: UInt8[np.ndarray, "h w 3"], width: int, height: int
) -> UInt8[np.ndarray, "..."]:
    """`image` as `width` x `height` px, no larger than it was.

    A new pixel is the mean of the old ones, weighted by how much of each it covers, so that a
    plane stays a plane and no detail is skipped, whatever the ratio.
    """
    if image.shape[:2] == (height, width):
        return image
    rows = _area_average(image.astype(np.float32), height)
    resized = _area_average(rows.transpose(1, 0, 2), width).transpose(1, 0, 2)
    return np.rint(resized).astype(np.uint8)


def _area_average(image: Float32[np.ndarray, "a b c"], count: int) -> Float32[np.ndarray, "n b c"]:
    """Means along the first axis."""
    flat = area_weights(len(image), count) @ image.reshape(len(image), -1)
    return flat.reshape(count, *image.shape[1:])


def area_weights(old: int, new: int) -> csr_array:
    """(new, old): the share of each new pixel that each old one fills; rows sum to 1."""
    edges = np.arange(new + 1)[:, None] * (old / new)
    old_edges = np.arange(old)
    overlap = np.minimum(edges[1:], old_edges + 1) - np.maximum(edges[:-1], old_edges)
    return csr_array((np.maximum(overlap, 0) * (new / old)).astype(np.float32))


@dataclass(frozen=True)
class FrameCamera:
    """What the file says of one camera, checked."""

    frame: Frame
    c2w: Float[np.ndarray, "4 4"]
    scale: float  # that its rotation carried
    size: tuple[int, int] | None  # (width, height) in px of which the intrinsics speak
    distortion: Distortion | None  # None: a pinhole


@dataclass(frozen=True)
class View:
    """One photograph, reduced, and its camera."""

    rgb: UInt8[np.ndarray, "h w 3"]
    K: Float[np.ndarray, "3 3"]  # of `rgb`
    camera: FrameCamera
    info: ImageInfo

    @property
    def is_rescaled(self) -> bool:
        """The camera speaks of another size than the file has."""
        return self.camera.size not in (None, self.info.size)


def parse_camera(frame: Frame) -> FrameCamera:
    """Raises BadArtifact that names the frame if its camera is none that we know, in space."""
    frame_label = str(frame)
    lens_distortion = parse_distortion(frame.camera_params, frame_label)
    return FrameCamera(
        frame,
        *parse_pose(frame.matrix, frame_label),
        image_size(frame.camera_params, frame_label),
        lens_distortion,
    )


def read_view(
    frame_camera: FrameCamera, path: Path, background: Float[np.ndarray, "3"], max_size: int
) -> View:
    """Read the photograph at `path`, straight, no long edge above `max_size` px.

    Raises BadArtifact if it is no image, or not of the shape that its camera speaks of.
    """
    frame_label = str(frame_camera.frame)
    rgb, info = read_image(path, background, frame_camera.size, frame_label)
    camera_size = frame_camera.size or info.size
    if not is_same_aspect(info.size, camera_size):
        raise BadArtifact(
            f"{frame_label}: {path} is {format_size(info.size)}, its camera says "
            f"{format_size(camera_size)}: another shape, so a crop or a turn "
            "that the intrinsics do not know of"
        )
    size = reduced_size(*info.size, max_size)
    K = intrinsics(frame_camera.frame.camera_params, *camera_size, frame_label)
    if frame_camera.distortion:
        # between pixels twice as fine: what is interpolated there is hardly blurred
        fine_size = reduced_size(*info.size, 2 * max_size)
        rgb, K = undistort(
            resize_area(rgb, *fine_size),
            scale_intrinsics(K, camera_size, fine_size),
            frame_camera.distortion,
            frame_label,
        )
        camera_size = fine_size
    return View(resize_area(rgb, *size), scale_intrinsics(K, camera_size, size), frame_camera, info)


def scale_intrinsics(
    K: Float[np.ndarray, "*n 3 3"], old_size: tuple[int, int], new_size: tuple[int, int]
) -> Float[np.ndarray, "*n 3 3"]:
    """K of the same images in another size, (width, height)."""
    # the image's corner is the origin of px, so the principal point scales as the lengths do
    return np.diag([new_size[0] / old_size[0], new_size[1] / old_size[1], 1.0]) @ K


def format_size(size: tuple[int, int]) -> str:
    """`size` for a message."""
    return f"{size[0]} x {size[1]} px"
