"""The visual hull: all of space that no silhouette excludes -- Laurentini (1994).

No method that looks at silhouettes alone can do better, and a pocket that no silhouette shows
stays filled.  Every view must have the whole part in frame; where a silhouette touches the
border of its image nothing is known beyond, and that view excludes nothing there.
"""

import numpy as np
from jaxtyping import Bool, Float

from industnerf.errors import ReconstructionFailed
from industnerf.geometry.cameras import Cameras
from industnerf.geometry.silhouettes import TOUCHED, part_in
from industnerf.methods.base import Given, Input, Method, Reconstruction, Scope
from industnerf.methods.hull.octree import refine
from industnerf.methods.hull.silhouettes import distance_images
from industnerf.methods.hull.surface import SEGMENT, draw
from industnerf.schema import HullRgbSettings, HullSettings

HINT = (
    "; it is seen where a pixel differs from the background by more than method.hull_rgb.tolerance"
)


def reconstruct_from_masks(
    given: Given, settings: HullSettings, state: None, seed: int
) -> Reconstruction:
    """The hull of the true masks."""
    return Reconstruction(hull(given.mask, given.cameras, settings, seed, grown_px=0.0))


def reconstruct_from_colour(
    given: Given, settings: HullRgbSettings, state: None, seed: int
) -> Reconstruction:
    """The hull of all pixels that differ from the background.

    A part of the background's own colour is taken for background and cut away.
    """
    mask = part_in(given.rgb, given.background, settings.tolerance)
    return Reconstruction(
        hull(mask, given.cameras, settings.hull, seed, grown_px=TOUCHED, hint=HINT)
    )


def hull(
    mask: Bool[np.ndarray, "n h w"],
    cameras: Cameras,
    settings: HullSettings,
    seed: int,
    *,
    grown_px: float,
    hint: str = "",
) -> Float[np.ndarray, "points 3"]:
    """Area-uniform points (mm) on the surface of the hull of `mask`.

    Raises ReconstructionFailed if there is no such surface.
    """
    blank = np.flatnonzero(~mask.any(axis=(1, 2)))
    if len(blank):
        raise ReconstructionFailed(
            f"{len(blank)} of {len(mask)} views show no part, the first of them view {blank[0]} "
            f"of those that were given{hint}"
        )
    seen = distance_images(mask, cameras, grown_px)
    families = refine(seen, settings.cell_px, SEGMENT)
    points = draw(seen, families, settings.points, np.random.default_rng(seed))
    return seen.centre + seen.radius_mm * points.astype(np.float64)


METHODS = {
    "hull": Method(
        "hull", Scope.PART, frozenset({Input.MASK}), reconstruct_from_masks, random=True
    ),
    "hull_rgb": Method(
        "hull_rgb",
        Scope.PART,
        frozenset({Input.RGB, Input.BACKGROUND}),
        reconstruct_from_colour,
        random=True,
    ),
}
