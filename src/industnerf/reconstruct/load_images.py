"""Photographs and their cameras, brought to one size."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float, UInt8

from industnerf.errors import BadArtifact
from industnerf.geometry.cameras import Cameras
from industnerf.reconstruct.image_paths import (
    check_images_dir,
    find_images,
    images_outside_dir,
    protected_paths,
    unlisted_images,
)
from industnerf.reconstruct.image_warnings import image_warnings, outside_dir_warnings
from industnerf.reconstruct.input_warnings import input_warnings
from industnerf.reconstruct.transforms import read_frames
from industnerf.reconstruct.views import View, format_size, parse_camera, read_view

WHITE = (1.0, 1.0, 1.0)


@dataclass(frozen=True)
class ImageSet:
    """What was read, and what a user should know of how."""

    rgb: UInt8[np.ndarray, "n h w 3"]
    cameras: Cameras  # in the frame and the unit of the file
    background: Float[np.ndarray, "n 3"] | None  # None: unknown
    image_paths: tuple[Path, ...]
    protected_paths: tuple[Path, ...]  # those of frames that are not used, too
    warnings: tuple[str, ...]


def load_images(
    transforms: Path,
    images_dir: Path | None,
    *,
    max_size: int,
    background: tuple[float, float, float] | None = None,
    all_frames: bool = False,
    on_image_loaded: Callable[[int, int], None] = lambda done, total: None,
) -> ImageSet:
    """Read what `transforms` names, no long edge above `longest` px.

    A photograph is looked for in `images`, if that is given, and then beside `transforms`.

    See-through pixels show `background` (sRGB in [0, 1]; None: white), which counts as known if
    it was given, or if every photograph is see-through.  `tick(done, of)` is called after each
    photograph.  Raises BadArtifact that names the file and the frame.
    """
    used_frames, listed_frames = read_frames(transforms, all_frames=all_frames)
    if len(used_frames) < 2:
        raise BadArtifact(f"{transforms}: {len(used_frames)} view to work on, it takes at least 2")
    frame_cameras = [
        parse_camera(frame) for frame in used_frames
    ]  # cheap, so before any pixel is read
    folders = (
        list(dict.fromkeys([images_dir, transforms.parent])) if images_dir else [transforms.parent]
    )
    check_images_dir(images_dir)
    image_paths = find_images(used_frames, folders)
    outside_paths = images_outside_dir(image_paths, images_dir)
    color = np.array(background or WHITE)
    views: list[View] = []
    for frame_camera, path in zip(frame_cameras, image_paths, strict=True):
        views.append(read_view(frame_camera, path, color, max_size))
        _check_same_size(views, image_paths)
        on_image_loaded(len(views), len(used_frames))
    has_known_background = background is not None or all(
        view.info.has_transparency for view in views
    )
    return ImageSet(
        np.stack([view.rgb for view in views]),
        _cameras(views),
        np.tile(color, (len(views), 1)) if has_known_background else None,
        tuple(image_paths),
        tuple(protected_paths(listed_frames, folders)),
        (
            *outside_dir_warnings(outside_paths, len(image_paths), images_dir),
            *image_warnings(
                views,
                len(listed_frames),
                color,
                unlisted_images(image_paths, listed_frames, folders),
            ),
            *input_warnings(views, None if background is None else color),
        ),
    )


def _cameras(views: Sequence[View]) -> Cameras:
    height, width = views[0].rgb.shape[:2]
    K, c2w = np.stack([view.K for view in views]), np.stack([view.camera.c2w for view in views])
    return Cameras(K, c2w, width, height)


def _check_same_size(views: Sequence[View], image_paths: Sequence[Path]) -> None:
    first, last = views[0].info.size, views[-1].info.size
    if first != last:
        raise BadArtifact(
            f"{image_paths[0]} is {format_size(first)} and {image_paths[len(views) - 1]} is {format_size(last)}: all "
            "photographs must have one size"
        )
