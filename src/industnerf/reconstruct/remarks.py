"""What was done to some of the photographs, a sentence each."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from industnerf.reconstruct.poses import SCALED
from industnerf.reconstruct.views import View, in_px


def remarks(views: Sequence[View], total: int, colour: Float[np.ndarray, "3"]) -> list[str]:
    """Sentences on `views`, which are those of `total` frames that are used."""
    height, width = views[0].rgb.shape[:2]
    hexed = "#" + "".join(f"{round(255 * value):02x}" for value in colour)
    counted = {
        "have another size than their cameras state: the intrinsics were scaled": [
            view.rescaled for view in views
        ],
        f"are see-through: shown over {hexed}": [view.photo.see_through for view in views],
        "were turned by their EXIF orientation, as their cameras are": [
            view.photo.turned for view in views
        ],
        "have a rotation that carries a scale, on which no ray depends: dropped": [
            abs(view.stand.scale - 1) > SCALED for view in views
        ],
        f"were reduced to {in_px((width, height))}": [
            view.photo.size != (width, height) for view in views
        ],
    }
    said = [
        f"{sum(which)} of {len(views)} photographs {text}"
        for text, which in counted.items()
        if any(which)
    ]
    if len(views) == total:
        return said
    chosen = f"{len(views)} of {total} frames are used, as `train_filenames` says"
    return [f"{chosen}; --all takes every one", *said]
