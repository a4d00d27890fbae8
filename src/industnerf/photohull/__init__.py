"""The photo hull: what space carving leaves of the visual hull.

"A Theory of Shape by Space Carving" -- Kutulakos and Seitz (2000).  A point of the surface has
one colour in all photographs that show it; where a pocket is closed by the hull, they show what
lies behind, each something else.  Flat pockets whose floor is as bright as their rim stay as
filled as in the visual hull.  `carve` answers with it, `industnerf_plus` starts from it.

The surface of the part is consistent, if it is as bright from all sides, and so what is left fills
every silhouette.  If it does not, that was no such surface -- metal shines, lamps move, cameras
are not where they are said to be -- and nothing that was carved is believed.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float32, UInt8

from industnerf.photohull.filling import filled
from industnerf.photohull.lattice import Rig, depth_in_hull
from industnerf.photohull.sweeps import Sweeper
from industnerf.schema import SpaceCarvingSettings

ANY = -0.5  # cells; a cell whose centre is so far outside holds some of the hull


@dataclass(frozen=True)
class Carved:
    """A lattice of cells before and after."""

    depth: Float32[np.ndarray, "r r r"]  # in the visual hull, cells; exact near its surface alone
    hull: Bool[np.ndarray, "r r r"]
    left: Bool[np.ndarray, "r r r"]  # the hull, unless the photographs are believed
    believed: bool
    hull_fills: float  # of the silhouettes
    rest_fills: float  # of the silhouettes; what the photographs do not contradict


def carved(
    distance: Float32[np.ndarray, "n h w"],
    rgb: UInt8[np.ndarray, "n h w 3"],
    rig: Rig,
    ways: SpaceCarvingSettings,
) -> Carved:
    """What photographs leave of the hull of their silhouettes.

    `distance` is what `geometry.silhouettes.outlines` says of the pixels that show the part.
    """
    mask = distance > 0
    depth = depth_in_hull(distance, rig, ways.grid_res)
    hull = depth > ANY
    rest = Sweeper(hull, rgb, rig, ways).carved(ways.sweeps) if hull.any() else hull
    of_hull, of_rest = (filled(solid, mask, rig) for solid in (hull, rest))
    believed = of_rest >= ways.least_filled * of_hull
    return Carved(depth, hull, rest if believed else hull, believed, of_hull, of_rest)


def remarks(cells: Carved, ways: SpaceCarvingSettings, then: str) -> tuple[str, ...]:
    """What is wrong with the photographs, a sentence each, and what comes of it: `then`."""
    said = []
    if cells.hull_fills < ways.least_filled:
        said.append(
            f"the silhouettes contradict each other: their hull fills {cells.hull_fills:.0%} of "
            "them; are cameras inexact, is the background plain, does the part glint in its colour?"
        )
    if not cells.believed:
        said.append(
            "the photographs contradict the silhouettes: what is alike from all sides fills "
            f"{cells.rest_fills:.0%} of them (least_filled), so {then}; "
            "does the part shine, did a light move, are cameras inexact?"
        )
    return tuple(said)
