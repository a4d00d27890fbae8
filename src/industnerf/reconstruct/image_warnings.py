"""What was done to some of the photographs, a sentence each."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from jaxtyping import Float

from industnerf.reconstruct.input_warnings import to_hex
from industnerf.reconstruct.poses import MIN_SCALE_DEVIATION
from industnerf.reconstruct.views import View, format_size

MAX_NAMED = 3  # of the images that are left out


def image_warnings(
    views: Sequence[View],
    num_listed: int,
    background: Float[np.ndarray, "3"],
    unlisted: Sequence[Path],
) -> list[str]:
    """Sentences on `views`, which are those of `total` frames that are used.

    `unnamed` are images beside theirs that no frame names.
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
    """A sentence on those of `total` photographs that are not in the folder `images`, if any."""
    if not outside_paths:
        return []
    return [
        f"{len(outside_paths)} of {total} photographs are not in --images {images_dir}: taken from where the "
        f"cameras are, the first as {outside_paths[0]}"
    ]


def unlisted_images_warning(unlisted: Sequence[Path]) -> str:
    """How many they are, and the names of the first."""
    names = ", ".join(path.name for path in unlisted[:MAX_NAMED])
    more = ", ..." if len(unlisted) > MAX_NAMED else ""
    return f"images that no frame names, left out: {len(unlisted)} ({names}{more})"
