"""The photo hull: what space carving leaves of the visual hull.

"A Theory of Shape by Space Carving" -- Kutulakos and Seitz (2000).  A point of the surface has
one color in all photographs that show it; where a pocket is closed by the hull, they show what
lies behind, each something else.  Flat pockets whose floor is as bright as their rim stay as
filled as in the visual hull.  `carve` answers with it, `industnerf_plus` starts from it.

The surface of the part is consistent, if it is as bright from all sides, and so what is left fills
every silhouette.  If it does not, that was no such surface -- metal shines, lamps move, cameras
are not where they are said to be -- and nothing that was carved is believed.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float32, UInt8

from industnerf.photohull.silhouette_coverage import silhouette_coverage
from industnerf.photohull.space_carving import SpaceCarver
from industnerf.photohull.voxel_grid import UnitFrameCameras, depth_in_hull
from industnerf.schema import SpaceCarvingSettings

HULL_MARGIN = -0.5  # cells; a cell whose center is so far outside holds some of the hull


@dataclass(frozen=True)
class CarvingResult:
    """A lattice of cells before and after."""

    depth: Float32[np.ndarray, "r r r"]  # in the visual hull, cells; exact near its surface alone
    hull: Bool[np.ndarray, "r r r"]
    solid: Bool[np.ndarray, "r r r"]  # the hull, unless the photographs are believed
    is_consistent: bool
    hull_coverage: float  # of the silhouettes
    carved_coverage: float  # of the silhouettes; what the photographs do not contradict


def carve_space(
    distance: Float32[np.ndarray, "n h w"],
    rgb: UInt8[np.ndarray, "n h w 3"],
    rig: UnitFrameCameras,
    settings: SpaceCarvingSettings,
) -> CarvingResult:
    """What photographs leave of the hull of their silhouettes.

    `distance` is what `geometry.silhouettes.outlines` says of the pixels that show the part.
    """
    mask = distance > 0
    depth = depth_in_hull(distance, rig, settings.grid_res)
    hull = depth > HULL_MARGIN
    remaining = (
        SpaceCarver(hull, rgb, rig, settings).carve(settings.max_sweeps) if hull.any() else hull
    )
    hull_coverage, carved_coverage = (
        silhouette_coverage(solid, mask, rig) for solid in (hull, remaining)
    )
    is_consistent = carved_coverage >= settings.min_silhouette_coverage * hull_coverage
    return CarvingResult(
        depth,
        hull,
        remaining if is_consistent else hull,
        is_consistent,
        hull_coverage,
        carved_coverage,
    )


def carving_warnings(
    result: CarvingResult, settings: SpaceCarvingSettings, consequence: str
) -> tuple[str, ...]:
    """What is wrong with the photographs, a sentence each, and what comes of it: `then`."""
    messages = []
    if result.hull_coverage < settings.min_silhouette_coverage:
        messages.append(
            f"the silhouettes contradict each other: their hull fills {result.hull_coverage:.0%} of "
            "them; are cameras inexact, is the background plain, does the part glint in its color?"
        )
    if not result.is_consistent:
        messages.append(
            "the photographs contradict the silhouettes: what is alike from all sides fills "
            f"{result.carved_coverage:.0%} of them (least_filled), so {consequence}; "
            "does the part shine, did a light move, are cameras inexact?"
        )
    return tuple(messages)
