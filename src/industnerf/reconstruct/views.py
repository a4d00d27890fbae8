"""One frame: where its camera stands, and its photograph at the size that is worked on."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float, UInt8

from industnerf.errors import BadArtifact
from industnerf.geometry.cameras import reduced_size
from industnerf.reconstruct.distortion import Distortion, straightened
from industnerf.reconstruct.lenses import distortion, intrinsics, stated_size
from industnerf.reconstruct.pixels import Facts, read_photo, same_shape
from industnerf.reconstruct.poses import pose
from industnerf.reconstruct.shrink import shrink
from industnerf.reconstruct.transforms import Shot


@dataclass(frozen=True)
class Stand:
    """What the file says of one camera, checked."""

    shot: Shot
    c2w: Float[np.ndarray, "4 4"]
    scale: float  # that its rotation carried
    size: tuple[int, int] | None  # (width, height) in px of which the intrinsics speak
    bent: Distortion | None  # None: a pinhole


@dataclass(frozen=True)
class View:
    """One photograph, reduced, and its camera."""

    rgb: UInt8[np.ndarray, "h w 3"]
    K: Float[np.ndarray, "3 3"]  # of `rgb`
    stand: Stand
    photo: Facts

    @property
    def rescaled(self) -> bool:
        """The camera speaks of another size than the file has."""
        return self.stand.size not in (None, self.photo.size)


def stand(shot: Shot) -> Stand:
    """Raises BadArtifact that names the frame if its camera is none that we know, in space."""
    where = str(shot)
    bent = distortion(shot.lens, where)
    return Stand(shot, *pose(shot.matrix, where), stated_size(shot.lens, where), bent)


def read_view(stand: Stand, path: Path, background: Float[np.ndarray, "3"], longest: int) -> View:
    """Read the photograph at `path`, straight, no long edge above `longest` px.

    Raises BadArtifact if it is no image, or not of the shape that its camera speaks of.
    """
    where = str(stand.shot)
    rgb, photo = read_photo(path, background, stand.size, where)
    camera = stand.size or photo.size
    if not same_shape(photo.size, camera):
        raise BadArtifact(
            f"{where}: {path} is {in_px(photo.size)}, its camera says {in_px(camera)}: another "
            "shape, so a crop or a turn that the intrinsics do not know of"
        )
    size = reduced_size(*photo.size, longest)
    K = intrinsics(stand.shot.lens, *camera, where)
    if stand.bent:  # between pixels twice as fine: what is interpolated there is hardly blurred
        fine = reduced_size(*photo.size, 2 * longest)
        rgb, K = straightened(shrink(rgb, *fine), scaled(K, camera, fine), stand.bent, where)
        camera = fine
    return View(shrink(rgb, *size), scaled(K, camera, size), stand, photo)


def scaled(
    K: Float[np.ndarray, "*n 3 3"], old: tuple[int, int], new: tuple[int, int]
) -> Float[np.ndarray, "*n 3 3"]:
    """K of the same images in another size, (width, height)."""
    # the image's corner is the origin of px, so the principal point scales as the lengths do
    return np.diag([new[0] / old[0], new[1] / old[1], 1.0]) @ K


def in_px(size: tuple[int, int]) -> str:
    """`size` for a message."""
    return f"{size[0]} x {size[1]} px"
