"""One photograph as 8-bit color, reduced and undistorted, with its camera.

What is see-through, by the photograph's own alpha or by a mask, shows nothing until a color behind
it is chosen: pixels are multiplied by their alpha, so that they may be averaged before that.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from jaxtyping import Float, Float32, UInt8
from PIL import Image, ImageOps
from scipy.ndimage import correlate1d
from scipy.sparse import csr_array

from industnerf.errors import BadArtifact
from industnerf.geometry.cameras import reduced_size
from industnerf.reconstruct.camera_files.frames import Frame
from industnerf.reconstruct.camera_models import (
    Distortion,
    image_size,
    intrinsics,
    parse_distortion,
    undistort,
)
from industnerf.reconstruct.poses import move_pose, parse_pose

EXIF_ORIENTATION, ROTATED_ORIENTATIONS = 0x0112, range(2, 9)  # the tag; 1 is upright, 0 unknown
MODES_16BIT = ("I;16", "I;16L", "I;16B", "I;16N")
MODES_8BIT = ("1", "L", "P", "RGB", "CMYK", "YCbCr")


@dataclass(frozen=True)
class ImageInfo:
    """What a photograph was, and what had to be decided to read it."""

    size: tuple[int, int]  # (width, height) in px, upright
    has_transparency: bool  # at least in one pixel, by alpha or mask
    is_rotated: bool  # its EXIF orientation was applied
    has_mask: bool = False


Pixels = UInt8[np.ndarray, "h w channels"]  # RGB, or RGB times alpha and alpha


def read_image(
    path: Path,
    camera_size: tuple[int, int] | None,
    frame_label: str,
    mask_path: Path | None = None,
) -> tuple[Pixels, ImageInfo]:
    """Read `path`: three channels, or four if some of it is see-through.

    `camera_size` is the (width, height) that its camera states, `mask_path` an image that is black
    where the photograph does not show the part.  Raises BadArtifact that names the file and the
    frame if one is no image, is torn, or holds pixels of an unknown kind.
    """
    with _opened(path, frame_label) as image:
        upright, is_rotated = _apply_exif_orientation(image, camera_size, path, frame_label)
        rgb, alpha = _rgb_and_alpha(upright, path, frame_label)
    if mask_path is not None:
        mask = read_mask(mask_path, upright.size, frame_label)
        alpha = mask if alpha is None else alpha * mask
    has_transparency = alpha is not None and bool((alpha < 1).any())
    info = ImageInfo(upright.size, has_transparency, is_rotated, mask_path is not None)
    if not has_transparency:
        return rgb, info
    channels = [rgb * alpha[..., None], 255 * alpha[..., None]]
    return np.rint(np.concatenate(channels, axis=2)).astype(np.uint8), info


@contextmanager
def _opened(path: Path, frame_label: str) -> Iterator[Image.Image]:
    try:
        with Image.open(path) as image:
            image.load()
            yield image
    except (OSError, SyntaxError, ValueError, Image.DecompressionBombError) as error:
        raise BadArtifact(f"{frame_label}: {path} cannot be read as an image: {error}") from None


def read_mask(path: Path, size: tuple[int, int], frame_label: str) -> Float32[np.ndarray, "h w"]:
    """The share in [0, 1] of each pixel that is the part: 1 where the mask is brightest.

    A mask of another size is scaled to `size`.  Raises BadArtifact if it has another shape.
    """
    with _opened(path, frame_label) as image:
        return _mask_values(image, path, size, frame_label)


def _mask_values(
    image: Image.Image, path: Path, size: tuple[int, int], frame_label: str
) -> Float32[np.ndarray, "h w"]:
    if not is_same_aspect(image.size, size):
        raise BadArtifact(
            f"{frame_label}: the mask {path} is {format_size(image.size)}, its photograph "
            f"{format_size(size)}: another shape"
        )
    if "A" in image.getbands() and image.getchannel("A").getextrema()[0] < 255:
        image = image.getchannel("A")
    elif image.mode not in MODES_16BIT:
        image = image.convert("L")
    if image.size != size:
        image = image.resize(size, Image.Resampling.NEAREST)
    values = np.asarray(image).astype(np.float32)
    alpha = values / max(float(values.max()), 1.0)
    is_binary = bool(((alpha == 0) | (alpha == 1)).all())
    return soften_edge(alpha) if is_binary else alpha


TOUCHED = 0.25  # of a smoothed mask, half a pixel outside its outline: so far a pixel reaches


def soften_edge(mask: Float32[np.ndarray, "h w"]) -> Float32[np.ndarray, "h w"]:
    """The share of each pixel that a solid covers, as far as a mask of pixels' centers tells.

    Methods find outlines where a photograph shows the least of a part, and would lose half a pixel.
    """
    for axis in (0, 1):
        mask = correlate1d(mask, [0.25, 0.5, 0.25], axis=axis, mode="nearest")
    return np.where(mask < TOUCHED, np.float32(0), mask)


def composite(pixels: Pixels, background: Float[np.ndarray, "3"]) -> UInt8[np.ndarray, "h w 3"]:
    """`pixels` over `background` (sRGB in [0, 1])."""
    if pixels.shape[2] == 3:
        return pixels
    clear = 1 - pixels[..., 3:].astype(np.float32) / 255
    shown = pixels[..., :3] + clear * (255 * background.astype(np.float32))
    return np.minimum(np.rint(shown), 255).astype(np.uint8)


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


def _rgb_and_alpha(
    image: Image.Image, path: Path, frame_label: str
) -> tuple[UInt8[np.ndarray, "h w 3"], Float32[np.ndarray, "h w"] | None]:
    if image.mode in ("RGBA", "LA", "PA") or "transparency" in image.info:
        rgba = np.asarray(image.convert("RGBA"))
        return rgba[..., :3], rgba[..., 3].astype(np.float32) / 255
    if image.mode in MODES_16BIT:
        gray = np.rint(np.asarray(image).astype(np.float32) / 257).astype(np.uint8)
        return np.repeat(gray[..., None], 3, axis=2), None
    if image.mode in MODES_8BIT:
        return np.asarray(image.convert("RGB")), None
    raise BadArtifact(
        f"{frame_label}: {path} holds pixels of kind {image.mode!r}; save it with 8 or 16 bits a "
        "channel"
    )


def resize_area(image: Pixels, width: int, height: int) -> UInt8[np.ndarray, "..."]:
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

    pixels: Pixels
    K: Float[np.ndarray, "3 3"]  # of `pixels`
    camera: FrameCamera
    info: ImageInfo

    @property
    def is_rescaled(self) -> bool:
        """The camera speaks of another size than the file has."""
        return self.camera.size not in (None, self.info.size)

    @property
    def size(self) -> tuple[int, int]:
        """(width, height) of `pixels`."""
        return self.pixels.shape[1], self.pixels.shape[0]

    @property
    def rgb(self) -> UInt8[np.ndarray, "h w 3"]:
        """The pixels, once a color is behind them."""
        if self.pixels.shape[2] != 3:
            raise ValueError("see-through pixels have no color before `over`")
        return self.pixels

    def over(self, background: Float[np.ndarray, "3"]) -> "View":
        """The view with `background` (sRGB in [0, 1]) where it is see-through."""
        return replace(self, pixels=composite(self.pixels, background))


def parse_camera(frame: Frame, to_frame: Float[np.ndarray, "4 4"] | None = None) -> FrameCamera:
    """The camera, in the frame that the similarity `to_frame` leads to.

    Raises BadArtifact that names the frame if its camera is none that we know, in space.
    """
    frame_label = str(frame)
    lens_distortion = parse_distortion(frame.camera_params, frame_label)
    c2w, scale = parse_pose(frame.matrix, frame_label)
    if to_frame is not None:
        c2w = move_pose(c2w, to_frame, frame_label)
    return FrameCamera(
        frame, c2w, scale, image_size(frame.camera_params, frame_label), lens_distortion
    )


def read_view(
    frame_camera: FrameCamera, path: Path, max_size: int, mask_path: Path | None = None
) -> View:
    """Read the photograph at `path`, straight, no long edge above `max_size` px.

    Raises BadArtifact if it is no image, or not of the shape that its camera speaks of.
    """
    frame_label = str(frame_camera.frame)
    pixels, info = read_image(path, frame_camera.size, frame_label, mask_path)
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
        pixels, K = undistort(
            resize_area(pixels, *fine_size),
            scale_intrinsics(K, camera_size, fine_size),
            frame_camera.distortion,
            frame_label,
        )
        camera_size = fine_size
    return View(
        resize_area(pixels, *size), scale_intrinsics(K, camera_size, size), frame_camera, info
    )


def scale_intrinsics(
    K: Float[np.ndarray, "*n 3 3"], old_size: tuple[int, int], new_size: tuple[int, int]
) -> Float[np.ndarray, "*n 3 3"]:
    """K of the same images in another size, (width, height)."""
    # the image's corner is the origin of px, so the principal point scales as the lengths do
    return np.diag([new_size[0] / old_size[0], new_size[1] / old_size[1], 1.0]) @ K


def format_size(size: tuple[int, int]) -> str:
    """`size` for a message."""
    return f"{size[0]} x {size[1]} px"
