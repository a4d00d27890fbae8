"""The visual hull: all of space that no silhouette excludes -- Laurentini (1994).

No method that looks at silhouettes alone can do better, and a pocket that no silhouette shows
stays filled.  Every view must have the whole part in frame; where a silhouette touches the
border of its image nothing is known beyond, and that view excludes nothing there.
"""

import numpy as np
from jaxtyping import Bool, Float

from industnerf.errors import ReconstructionFailed
from industnerf.geometry.cameras import Cameras
from industnerf.geometry.silhouettes import BOUNDARY_OFFSET_PX, foreground_mask
from industnerf.methods.base import Input, Method, MethodInputs, Reconstruction, Scope
from industnerf.methods.hull.octree import refine
from industnerf.methods.hull.silhouettes import distance_images
from industnerf.methods.hull.surface import SEGMENT_LENGTH, sample_hull_surface
from industnerf.schema import HullRgbSettings, HullSettings

HINT = (
    "; it is seen where a pixel differs from the background by more than "
    "method.hull_rgb.background_tolerance"
)


def reconstruct_from_masks(
    inputs: MethodInputs, settings: HullSettings, state: None, seed: int
) -> Reconstruction:
    """The hull of the true masks."""
    return Reconstruction(hull(inputs.mask, inputs.cameras, settings, seed, dilation_px=0.0))


def reconstruct_from_color(
    inputs: MethodInputs, settings: HullRgbSettings, state: None, seed: int
) -> Reconstruction:
    """The hull of all pixels that differ from the background.

    A part of the background's own color is taken for background and cut away.
    """
    mask = foreground_mask(inputs.rgb, inputs.background, settings.background_tolerance)
    return Reconstruction(
        hull(mask, inputs.cameras, settings.hull, seed, dilation_px=BOUNDARY_OFFSET_PX, hint=HINT)
    )


def hull(
    mask: Bool[np.ndarray, "n h w"],
    cameras: Cameras,
    settings: HullSettings,
    seed: int,
    *,
    dilation_px: float,
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
    silhouettes = distance_images(mask, cameras, dilation_px)
    nodes = refine(silhouettes, settings.cell_px, SEGMENT_LENGTH)
    points = sample_hull_surface(silhouettes, nodes, settings.points, np.random.default_rng(seed))
    return silhouettes.center + silhouettes.radius_mm * points.astype(np.float64)


METHODS = {
    "hull": Method(
        "hull", Scope.PART, frozenset({Input.MASK}), reconstruct_from_masks, is_stochastic=True
    ),
    "hull_rgb": Method(
        "hull_rgb",
        Scope.PART,
        frozenset({Input.RGB, Input.BACKGROUND}),
        reconstruct_from_color,
        is_stochastic=True,
    ),
}
