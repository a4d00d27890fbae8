"""Which frames of a camera file are used, in which frame and unit, and where their files are."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float

from industnerf.errors import BadArtifact
from industnerf.reconstruct.camera_files.frames import CameraFile, Frame
from industnerf.reconstruct.image_paths import (
    ImageFinder,
    check_images_dir,
    find_images,
    images_outside_dir,
    no_such_photograph,
    protected_paths,
    unlisted_images,
)
from industnerf.reconstruct.images import FrameCamera, parse_camera
from industnerf.reconstruct.scale import Scale, find_frame, scale_factor

MAX_NAMED = 3  # of the files or frames that are left out


@dataclass(frozen=True)
class Selection:
    """Which frames of a camera file to use, and how."""

    all_frames: bool = False  # not train_filenames alone
    exclude: tuple[str, ...] = ()  # names of frames
    strict: bool = False  # refuse where a photograph or a mask is missing
    ignore_masks: bool = False
    undo_transform: bool = False  # poses in the frame that they were moved from
    scale: Scale | None = None  # None: the unit of the cameras


@dataclass(frozen=True)
class Sources:
    """The frames whose photographs are there, and what a user should know of the others."""

    cameras: tuple[FrameCamera, ...]
    image_paths: tuple[Path, ...]
    mask_paths: tuple[Path | None, ...]
    protected_paths: tuple[Path, ...]  # those of frames that are not used, too
    warnings: tuple[str, ...]


def find_sources(camera_file: CameraFile, images_dir: Path | None, selection: Selection) -> Sources:
    """The frames of `selection`, with their files, which are looked for in `images_dir` first.

    Raises BadArtifact that names the frame if a camera is none that we know, fewer than two are
    left, or `selection` is strict and something is missing.
    """
    listed = camera_file.frames
    frames = camera_file.frames_to_use(all_frames=selection.all_frames)
    frames = _without_excluded(camera_file, frames, selection.exclude)
    check_count(camera_file.path, len(frames))
    to_frame, frame_words = _frame_change(camera_file, selection)
    # cheap, so before any pixel is read
    cameras = [parse_camera(frame, to_frame) for frame in frames]
    check_images_dir(images_dir)
    finder = ImageFinder(
        tuple(dict.fromkeys([*([images_dir] if images_dir else []), *camera_file.folders]))
    )
    found = find_images(frames, finder)
    missing = [frame for frame, path in zip(frames, found, strict=True) if path is None]
    if missing and selection.strict:
        raise BadArtifact(
            f"{no_such_photograph(missing[0], finder)}; --strict is given, and "
            f"{_count_and_names([frame.name for frame in missing], len(frames))} have none"
        )
    cameras = [camera for camera, path in zip(cameras, found, strict=True) if path]
    image_paths = [path for path in found if path]
    check_count(camera_file.path, len(image_paths), f"{len(missing)} photographs are missing")
    used_frames = [camera.frame for camera in cameras]
    masks, mask_words = _find_masks(used_frames, image_paths, finder, selection)
    protected = [*protected_paths(listed, finder), *(mask for mask in masks if mask)]
    warnings = [
        *_usage_words(len(frames), len(listed), selection),
        *missing_warning([frame.name for frame in missing], len(frames)),
        *outside_dir_warnings(
            images_outside_dir(image_paths, images_dir), len(image_paths), images_dir
        ),
        *unlisted_images_warning(unlisted_images(image_paths, protected)),
        *frame_words,
        *mask_words,
    ]
    return Sources(
        tuple(cameras), tuple(image_paths), tuple(masks), tuple(protected), tuple(warnings)
    )


def check_count(path: Path, count: int, reason: str = "") -> None:
    """Raise BadArtifact if there are too few views to work on."""
    if count < 2:
        raise BadArtifact(
            f"{path}: {count} view to work on, it takes at least 2" + (reason and f": {reason}")
        )


def _without_excluded(
    camera_file: CameraFile, frames: Sequence[Frame], names: Sequence[str]
) -> list[Frame]:
    excluded = set()
    for name in names:
        frame = find_frame(name, camera_file.frames)
        if frame is None:
            raise BadArtifact(
                f"--exclude {name}: {camera_file.path} lists no frame of that name, or several"
            )
        excluded.add(frame.index)
    return [frame for frame in frames if frame.index not in excluded]


def _frame_change(
    camera_file: CameraFile, selection: Selection
) -> tuple[Float[np.ndarray, "4 4"] | None, list[str]]:
    """What takes poses of the file to the frame and unit that are asked for, and words on it."""
    to_frame, words = np.eye(4), []
    if camera_file.poses_before is not None and selection.undo_transform:
        to_frame = camera_file.poses_before
        words.append(f"{camera_file.moved_by} undone: the cloud is in the frame before it")
    elif camera_file.poses_before is not None:
        words.append(
            f"{camera_file.moved_by} not undone: the cloud is in the frame of the poses as they "
            "stand; --undo-transform gives the frame before"
        )
    elif selection.undo_transform:
        words.append(f"--undo-transform: {camera_file.path} says of no transform of its poses")
    if selection.scale is not None:
        factor = scale_factor(selection.scale, camera_file.frames, to_frame)
        to_frame = np.diag([factor, factor, factor, 1.0]) @ to_frame
        words.append(f"scaled by {factor:.6g}, so that --scale's distance is in mm: so is all else")
    return (None if np.array_equal(to_frame, np.eye(4)) else to_frame), words


def _find_masks(
    frames: Sequence[Frame],
    image_paths: Sequence[Path],
    finder: ImageFinder,
    selection: Selection,
) -> tuple[list[Path | None], list[str]]:
    if selection.ignore_masks or not any(frame.mask_name for frame in frames):
        return [None] * len(frames), []
    taken = {path.resolve() for path in image_paths}
    masks = [frame.mask_name and finder.find(frame.mask_name, taken) for frame in frames]
    without = [frame for frame, mask in zip(frames, masks, strict=True) if mask is None]
    if not without:
        return masks, []
    text = f"{_count_and_names([frame.name for frame in without], len(frames))} have no mask"
    if selection.strict:
        raise BadArtifact(f"{text}, the first should be {without[0].mask_name}; --strict is given")
    return masks, [f"{text}: outlines are looked for by color"]


def _usage_words(used: int, listed: int, selection: Selection) -> list[str]:
    words = []
    excluded = len(selection.exclude)
    if excluded:
        words.append(f"{excluded} of {listed} frames are left out, as --exclude says")
    if used + excluded < listed and not selection.all_frames:
        words.append(
            f"{used} of {listed} frames are used, as `train_filenames` says; --all-frames takes "
            "every one"
        )
    return words


def missing_warning(names: Sequence[str], total: int) -> list[str]:
    """A sentence on the frames that have no photograph, if any."""
    if not names:
        return []
    return [f"{_count_and_names(names, total)} have no photograph: left out (--strict refuses)"]


def _count_and_names(names: Sequence[str], total: int) -> str:
    more = ", ..." if len(names) > MAX_NAMED else ""
    return f"{len(names)} of {total} frames ({', '.join(names[:MAX_NAMED])}{more})"


def outside_dir_warnings(
    outside_paths: Sequence[Path], total: int, images_dir: Path | None
) -> list[str]:
    """A sentence on those of `total` photographs that are not in `images_dir`, if any."""
    if not outside_paths:
        return []
    return [
        f"{len(outside_paths)} of {total} photographs are not in --images {images_dir}: taken from "
        f"where the cameras are, the first as {outside_paths[0]}"
    ]


def unlisted_images_warning(unlisted: Sequence[Path]) -> list[str]:
    """How many they are, and the names of the first, if any."""
    if not unlisted:
        return []
    names = ", ".join(path.name for path in unlisted[:MAX_NAMED])
    more = ", ..." if len(unlisted) > MAX_NAMED else ""
    return [f"images that no frame names, left out: {len(unlisted)} ({names}{more})"]
