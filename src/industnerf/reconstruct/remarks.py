"""What was done to some of the photographs, a sentence each."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from jaxtyping import Float

from industnerf.reconstruct.doubts import hexed
from industnerf.reconstruct.poses import SCALED
from industnerf.reconstruct.views import View, in_px

NAMED = 3  # of the images that are left out


def remarks(
    views: Sequence[View],
    total: int,
    colour: Float[np.ndarray, "3"],
    unnamed: Sequence[Path],
) -> list[str]:
    """Sentences on `views`, which are those of `total` frames that are used.

    `unnamed` are images beside theirs that no frame names.
    """
    height, width = views[0].rgb.shape[:2]
    counted = {
        "have another size than their cameras state: the intrinsics were scaled": [
            view.rescaled for view in views
        ],
        f"are see-through: shown over {hexed(colour)}": [view.photo.see_through for view in views],
        "were turned by their EXIF orientation, as their cameras are": [
            view.photo.turned for view in views
        ],
        "have a rotation that carries a scale, on which no ray depends: dropped": [
            abs(view.stand.scale - 1) > SCALED for view in views
        ],
        "were straightened, as their lens bends lines": [view.stand.bent for view in views],
        f"were reduced to {in_px((width, height))}": [
            view.photo.size != (width, height) for view in views
        ],
    }
    said = [
        f"{sum(map(bool, which))} of {len(views)} photographs {text}"
        for text, which in counted.items()
        if any(which)
    ]
    if unnamed:
        said.insert(0, left_out(unnamed))
    if len(views) == total:
        return said
    chosen = f"{len(views)} of {total} frames are used, as `train_filenames` says"
    return [f"{chosen}; --all takes every one", *said]


def found_elsewhere(strays: Sequence[Path], total: int, images: Path | None) -> list[str]:
    """A sentence on those of `total` photographs that are not in the folder `images`, if any."""
    if not strays:
        return []
    return [
        f"{len(strays)} of {total} photographs are not in --images {images}: taken from where the "
        f"cameras are, the first as {strays[0]}"
    ]


def left_out(unnamed: Sequence[Path]) -> str:
    """How many they are, and the names of the first."""
    names = ", ".join(path.name for path in unnamed[:NAMED])
    more = ", ..." if len(unnamed) > NAMED else ""
    return f"images that no frame names, left out: {len(unnamed)} ({names}{more})"
