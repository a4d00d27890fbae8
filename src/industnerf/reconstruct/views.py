"""One frame: where its camera stands, and its photograph at the size that is worked on."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float, UInt8

from industnerf.errors import BadArtifact
from industnerf.geometry.cameras import reduced_size
from industnerf.reconstruct.camera_models import image_size, intrinsics, parse_distortion
from industnerf.reconstruct.distortion import Distortion, undistort
from industnerf.reconstruct.images import ImageInfo, is_same_aspect, read_image
from industnerf.reconstruct.poses import parse_pose
from industnerf.reconstruct.resize import resize_area
from industnerf.reconstruct.transforms import Frame


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
    """Read the photograph at `path`, straight, no long edge above `longest` px.

    Raises BadArtifact if it is no image, or not of the shape that its camera speaks of.
    """
    frame_label = str(frame_camera.frame)
    rgb, info = read_image(path, background, frame_camera.size, frame_label)
    camera_size = frame_camera.size or info.size
    if not is_same_aspect(info.size, camera_size):
        raise BadArtifact(
            f"{frame_label}: {path} is {format_size(info.size)}, its camera says {format_size(camera_size)}: another "
            "shape, so a crop or a turn that the intrinsics do not know of"
        )
    size = reduced_size(*info.size, max_size)
    K = intrinsics(frame_camera.frame.camera_params, *camera_size, frame_label)
    if (
        frame_camera.distortion
    ):  # between pixels twice as fine: what is interpolated there is hardly blurred
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
