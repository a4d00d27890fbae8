"""Photographs and their cameras, brought to one size, and warnings about what they look like."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float, UInt8

from industnerf.geometry.cameras import Cameras
from industnerf.geometry.silhouettes import border
from industnerf.reconstruct.camera_files import read_camera_file
from industnerf.reconstruct.canvas import crop_to_region, framing_cameras, have_one_size
from industnerf.reconstruct.images import View, format_size, read_view
from industnerf.reconstruct.poses import MIN_SCALE_DEVIATION
from industnerf.reconstruct.region import region_of_interest
from industnerf.reconstruct.see_through import choose_background, covers_border, shows_nothing
from industnerf.reconstruct.sources import Selection, check_count, find_sources

Triple = tuple[float, float, float]
ALL = Selection()


@dataclass(frozen=True)
class ImageSet:
    """What was read, and what a user should know of how."""

    rgb: UInt8[np.ndarray, "n h w 3"]
    cameras: Cameras  # in the frame and the unit that were asked for
    background: Float[np.ndarray, "n 3"] | None  # None: unknown
    center: Float[np.ndarray, "3"]  # of the region of interest
    radius: float
    image_paths: tuple[Path, ...]
    names: tuple[str, ...]  # of the photographs, in the camera file
    protected_paths: tuple[Path, ...]  # those of frames that are not used, too
    warnings: tuple[str, ...]
    is_colmap: bool = False  # the camera file is a model of COLMAP


def load_images(
    cameras: Path,
    images_dir: Path | None,
    *,
    max_size: int,
    background: Triple | None = None,
    selection: Selection = ALL,
    center: Triple | None = None,
    radius: float | None = None,
    on_image_loaded: Callable[[int, int], None] = lambda done, total: None,
) -> ImageSet:
    """Read what `cameras` names, no long edge above `max_size` px.

    A photograph is looked for in `images_dir`, if that is given, and then beside `cameras`.

    See-through and masked pixels show `background` (sRGB in [0, 1]; None: a color that the part
    has not), which counts as known if it was given, or if every photograph has such pixels.
    `center` and `radius` override the region of interest.  `on_image_loaded(done, total)` is
    called after each photograph.  Raises BadArtifact that names the file and the frame.
    """
    camera_file = read_camera_file(cameras)
    sources = find_sources(camera_file, images_dir, selection)
    views: list[View] = []
    for frame_camera, path, mask_path in zip(
        sources.cameras, sources.image_paths, sources.mask_paths, strict=True
    ):
        views.append(read_view(frame_camera, path, max_size, mask_path))
        on_image_loaded(len(views), len(sources.cameras))
    is_shown = [not shows_nothing(view) for view in views]
    views = [view for view, shown in zip(views, is_shown, strict=True) if shown]
    check_count(cameras, len(views), f"{is_shown.count(False)} masks leave nothing")
    mask_words = mask_warnings(views, is_shown.count(False))
    is_known = background is not None or all(view.info.has_transparency for view in views)
    color = choose_background(views) if background is None else np.array(background)
    views = [view.over(color) for view in views]
    names = tuple(view.camera.frame.name for view in views)
    center, radius = region_of_interest(framing_cameras(views), names, center, radius)
    windows = views
    if not have_one_size(views):
        windows = crop_to_region(views, center, radius, color if is_known else None)
    return ImageSet(
        np.stack([view.rgb for view in windows]),
        framing_cameras(windows),
        np.tile(color, (len(views), 1)) if is_known else None,
        center,
        radius,
        tuple(path for path, shown in zip(sources.image_paths, is_shown, strict=True) if shown),
        names,
        sources.protected_paths,
        (
            *camera_file.warnings,
            *sources.warnings,
            *mask_words,
            *image_warnings(views, windows, color),
            *input_warnings(windows, None if background is None else color),
        ),
        camera_file.is_colmap,
    )


def mask_warnings(views: Sequence[View], num_empty: int) -> list[str]:
    """Sentences on masks that show nothing, and on those that are no outline of a part."""
    warnings = []
    if num_empty:
        warnings.append(f"{num_empty} photographs are left out, as their masks leave nothing")
    num_wide = sum(covers_border(view) for view in views)
    if num_wide:
        warnings.append(
            f"{num_wide} of {len(views)} masks keep most of the border of the photograph: a mask "
            "is white where the part is and black elsewhere; --ignore-masks does without"
        )
    return warnings


def image_warnings(
    views: Sequence[View], windows: Sequence[View], background: Float[np.ndarray, "3"]
) -> list[str]:
    """Sentences on `views`, and on the `windows` of them that are used."""
    color = to_hex(background)
    flags_by_message = {
        "have another size than their cameras state: the intrinsics were scaled": [
            view.is_rescaled for view in views
        ],
        f"are see-through: shown over {color}": [
            view.info.has_transparency and not view.info.has_mask for view in views
        ],
        f"are cut out by their masks: shown over {color}": [view.info.has_mask for view in views],
        "were turned by their EXIF orientation, as their cameras are": [
            view.info.is_rotated for view in views
        ],
        "have a rotation that carries a scale, on which no ray depends: dropped": [
            abs(view.camera.scale - 1) > MIN_SCALE_DEVIATION for view in views
        ],
        "were straightened, as their lens bends lines": [view.camera.distortion for view in views],
    }
    for size in dict.fromkeys(view.size for view in views):
        flags_by_message[f"were reduced to {format_size(size)}"] = [
            view.size == size != view.info.size for view in views
        ]
    warnings = [
        f"{sum(map(bool, flags))} of {len(views)} photographs {text}"
        for text, flags in flags_by_message.items()
        if any(flags)
    ]
    if windows is not views:
        sizes = len({view.size for view in views})
        warnings.append(
            f"photographs have {sizes} sizes: of each a window of {format_size(windows[0].size)} "
            "about the region of interest is used"
        )
    return warnings


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
