"""Photographs and their cameras, brought to one size."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float, UInt8

from industnerf.errors import BadArtifact
from industnerf.geometry.cameras import Cameras
from industnerf.reconstruct.doubts import doubts
from industnerf.reconstruct.places import check_images, elsewhere, find_photos, owned, unnamed
from industnerf.reconstruct.remarks import found_elsewhere, remarks
from industnerf.reconstruct.transforms import read_shots
from industnerf.reconstruct.views import View, in_px, read_view, stand

WHITE = (1.0, 1.0, 1.0)


@dataclass(frozen=True)
class Album:
    """What was read, and what a user should know of how."""

    rgb: UInt8[np.ndarray, "n h w 3"]
    cameras: Cameras  # in the frame and the unit of the file
    background: Float[np.ndarray, "n 3"] | None  # None: unknown
    photos: tuple[Path, ...]
    owned: tuple[Path, ...]  # those of frames that are not used, too
    remarks: tuple[str, ...]


def gather(
    transforms: Path,
    images: Path | None,
    *,
    longest: int,
    background: tuple[float, float, float] | None = None,
    every: bool = False,
    tick: Callable[[int, int], None] = lambda done, of: None,
) -> Album:
    """Read what `transforms` names, no long edge above `longest` px.

    A photograph is looked for in `images`, if that is given, and then beside `transforms`.

    See-through pixels show `background` (sRGB in [0, 1]; None: white), which counts as known if
    it was given, or if every photograph is see-through.  `tick(done, of)` is called after each
    photograph.  Raises BadArtifact that names the file and the frame.
    """
    shots, frames = read_shots(transforms, every=every)
    if len(shots) < 2:
        raise BadArtifact(f"{transforms}: {len(shots)} view to work on, it takes at least 2")
    stands = [stand(shot) for shot in shots]  # cheap, so before any pixel is read
    folders = list(dict.fromkeys([images, transforms.parent])) if images else [transforms.parent]
    check_images(images)
    photos = find_photos(shots, folders)
    strays = elsewhere(photos, images)
    colour = np.array(background or WHITE)
    views: list[View] = []
    for where, path in zip(stands, photos, strict=True):
        views.append(read_view(where, path, colour, longest))
        _check_size(views, photos)
        tick(len(views), len(shots))
    known = background is not None or all(view.photo.see_through for view in views)
    return Album(
        np.stack([view.rgb for view in views]),
        _cameras(views),
        np.tile(colour, (len(views), 1)) if known else None,
        tuple(photos),
        tuple(owned(frames, folders)),
        (
            *found_elsewhere(strays, len(photos), images),
            *remarks(views, len(frames), colour, unnamed(photos, frames, folders)),
            *doubts(views, None if background is None else colour),
        ),
    )


def _cameras(views: Sequence[View]) -> Cameras:
    height, width = views[0].rgb.shape[:2]
    K, c2w = np.stack([view.K for view in views]), np.stack([view.stand.c2w for view in views])
    return Cameras(K, c2w, width, height)


def _check_size(views: Sequence[View], photos: Sequence[Path]) -> None:
    first, last = views[0].photo.size, views[-1].photo.size
    if first != last:
        raise BadArtifact(
            f"{photos[0]} is {in_px(first)} and {photos[len(views) - 1]} is {in_px(last)}: all "
            "photographs must have one size"
        )
