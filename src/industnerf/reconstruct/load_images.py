"""Photographs and their cameras, brought to one size, and warnings about what they look like."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float, UInt8

from industnerf.errors import BadArtifact
from industnerf.geometry.cameras import Cameras
from industnerf.geometry.silhouettes import border
from industnerf.reconstruct.images import View, format_size, parse_camera, read_view
from industnerf.reconstruct.transforms import (
    MIN_SCALE_DEVIATION,
    check_images_dir,
    find_images,
    images_outside_dir,
    protected_paths,
    read_frames,
    unlisted_images,
)

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
    """Read what `transforms` names, no long edge above `max_size` px.

    A photograph is looked for in `images_dir`, if that is given, and then beside `transforms`.

    See-through pixels show `background` (sRGB in [0, 1]; None: white), which counts as known if
    it was given, or if every photograph is see-through.  `on_image_loaded(done, total)` is
    called after each photograph.  Raises BadArtifact that names the file and the frame.
    """
    used_frames, listed_frames = read_frames(transforms, all_frames=all_frames)
    if len(used_frames) < 2:
        raise BadArtifact(f"{transforms}: {len(used_frames)} view to work on, it takes at least 2")
    # cheap, so before any pixel is read
    frame_cameras = [parse_camera(frame) for frame in used_frames]
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
            f"{image_paths[0]} is {format_size(first)} and {image_paths[len(views) - 1]} is "
            f"{format_size(last)}: all photographs must have one size"
        )


MAX_NAMED = 3  # of the images that are left out


def image_warnings(
    views: Sequence[View],
    num_listed: int,
    background: Float[np.ndarray, "3"],
    unlisted: Sequence[Path],
) -> list[str]:
    """Sentences on `views`, the frames that are used of `num_listed`.

    `unlisted` are images beside theirs that no frame names.
    """
    height, width = views[0].rgb.shape[:2]
    flags_by_message = {
        "have another size than their cameras state: the intrinsics were scaled": [
            view.is_rescaled for view in views
        ],
        f"are see-through: shown over {to_hex(background)}": [
            view.info.has_transparency for view in views
        ],
        "were turned by their EXIF orientation, as their cameras are": [
            view.info.is_rotated for view in views
        ],
        "have a rotation that carries a scale, on which no ray depends: dropped": [
            abs(view.camera.scale - 1) > MIN_SCALE_DEVIATION for view in views
        ],
        "were straightened, as their lens bends lines": [view.camera.distortion for view in views],
        f"were reduced to {format_size((width, height))}": [
            view.info.size != (width, height) for view in views
        ],
    }
    warnings = [
        f"{sum(map(bool, flags))} of {len(views)} photographs {text}"
        for text, flags in flags_by_message.items()
        if any(flags)
    ]
    if unlisted:
        warnings.insert(0, unlisted_images_warning(unlisted))
    if len(views) == num_listed:
        return warnings
    usage = f"{len(views)} of {num_listed} frames are used, as `train_filenames` says"
    return [f"{usage}; --all-frames takes every one", *warnings]


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


def unlisted_images_warning(unlisted: Sequence[Path]) -> str:
    """How many they are, and the names of the first."""
    names = ", ".join(path.name for path in unlisted[:MAX_NAMED])
    more = ", ..." if len(unlisted) > MAX_NAMED else ""
    return f"images that no frame names, left out: {len(unlisted)} ({names}{more})"


MAX_BACKGROUND_DIFFERENCE = 255 / 8  # in a channel: more than light that falls off, or compression
BLACK_THRESHOLD = 255 / 8  # 12 bits of 16 end at 255 / 16
MAX_FOV_DEG, MIN_FOV_DEG = 120.0, 1.0  # degrees; beyond, a pinhole camera is a slip


def input_warnings(views: Sequence[View], background: Float[np.ndarray, "3"] | None) -> list[str]:
    """Sentences on what is unusual in `views`; `background` (sRGB in [0, 1]) is what was given."""
    warnings = [
        _background_warning(views, background),
        _field_of_view_warning(views),
        _dark_image_warning(views),
    ]
    return [warning for warning in warnings if warning]


def _background_warning(
    views: Sequence[View], background: Float[np.ndarray, "3"] | None
) -> str | None:
    """Where a photograph is see-through it shows `background`, so is not unlike it."""
    if background is None:
        return None
    borders = [border(view.rgb) for view in views]
    mismatched = [
        border_pixels for border_pixels in borders if _differs_from(border_pixels, 255 * background)
    ]
    if not mismatched:
        return None
    color = np.median(np.concatenate(mismatched), axis=0)
    return (
        f"{len(mismatched)} of {len(views)} photographs have a border unlike --background "
        f"{to_hex(background)}, in the median {to_hex(color / 255)}: give the color behind the "
        "part, or leave --background out"
    )


def _differs_from(border_pixels: UInt8[np.ndarray, "n 3"], color: Float[np.ndarray, "3"]) -> bool:
    """Whether most of them do: a part may reach over some of the border."""
    return bool(
        (np.abs(border_pixels - color).max(axis=1) > MAX_BACKGROUND_DIFFERENCE).mean() > 0.5
    )


def to_hex(color: Float[np.ndarray, "3"]) -> str:
    """sRGB in [0, 1] as #rrggbb."""
    return "#" + "".join(f"{round(255 * float(value)):02x}" for value in color)


def _field_of_view_warning(views: Sequence[View]) -> str | None:
    angles = [
        angle for view in views if not MIN_FOV_DEG <= (angle := field_of_view(view)) <= MAX_FOV_DEG
    ]
    if not angles:
        return None
    return (
        f"{len(angles)} of {len(views)} photographs have a field of view above {MAX_FOV_DEG:g} "
        f"or below {MIN_FOV_DEG:g} degrees, the first of {angles[0]:.3g}: are fl_x and fl_y in px, "
        "not in mm, of an image of w x h px?"
    )


def field_of_view(view: View) -> float:
    """Degrees along the edge along which it is larger, as if the principal point were amid it."""
    height, width = view.rgb.shape[:2]
    tan_half_fov = max(width / 2 / view.K[0, 0], height / 2 / view.K[1, 1])
    return float(np.degrees(2 * np.arctan(tan_half_fov)))


def _dark_image_warning(views: Sequence[View]) -> str | None:
    dark = [max_value for view in views if (max_value := int(view.rgb.max())) < BLACK_THRESHOLD]
    if not dark:
        return None
    return (
        f"{len(dark)} of {len(views)} photographs are all but black, with no value above "
        f"{max(dark)} of 255; so look 12-bit values in 16-bit files: multiply those by 16"
    )
