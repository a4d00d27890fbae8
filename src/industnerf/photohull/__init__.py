"""The photo hull: what space carving leaves of the visual hull.

"A Theory of Shape by Space Carving" -- Kutulakos and Seitz (2000).  A point of the surface has
one color in all photographs that show it.  Where the hull closes a pocket, each photograph shows
another point behind it, of another color.  Flat pockets whose floor is as bright as their rim stay
as filled as in the visual hull.  `carve` returns the photo hull, `industnerf_plus` starts from it.

The surface of a part is consistent if it is as bright from all sides; what is left then covers
every silhouette.  If it does not, the photographs are inconsistent (metal shines, lamps move,
cameras are inexact), and the visual hull is returned instead.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float32, UInt8
from scipy.ndimage import maximum_filter

from industnerf.photohull.space_carving import SpaceCarver, surface_voxels
from industnerf.photohull.voxel_grid import UnitFrameCameras, depth_in_hull
from industnerf.schema import SpaceCarvingSettings

HULL_MARGIN = -0.5  # cells; a cell whose center is so far outside holds some of the hull


@dataclass(frozen=True)
class CarvingResult:
    """A cubic grid of cells before and after carving."""

    depth: Float32[np.ndarray, "r r r"]  # in the visual hull, cells; exact near its surface alone
    hull: Bool[np.ndarray, "r r r"]
    solid: Bool[np.ndarray, "r r r"]  # what carving leaves; the hull if it is not consistent
    is_consistent: bool
    hull_coverage: float  # share of the silhouettes that the hull covers
    carved_coverage: float  # the same of what carving leaves


def carve_space(
    distance: Float32[np.ndarray, "n h w"],
    rgb: UInt8[np.ndarray, "n h w 3"],
    rig: UnitFrameCameras,
    settings: SpaceCarvingSettings,
) -> CarvingResult:
    """Carve the hull of the silhouettes by the photographs.

    `distance` (px) is that of `geometry.silhouettes.silhouette_distances`, > 0 inside, which ends
    at MAX_DISTANCE_PX, or one that goes on.
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
    """What is wrong with the photographs, a sentence each; `consequence` says what is done."""
    messages = []
    if result.hull_coverage < settings.min_silhouette_coverage:
        messages.append(
            "the silhouettes contradict each other: their hull covers "
            f"{result.hull_coverage:.0%} of them; are cameras inexact, is the background plain, "
            "does the part glint in its color?"
        )
    if not result.is_consistent:
        messages.append(
            "the photographs contradict the silhouettes: what is alike from all sides covers "
            f"{result.carved_coverage:.0%} of them (min_silhouette_coverage), so {consequence}; "
            "does the part shine, did a light move, are cameras inexact?"
        )
    return tuple(messages)


def silhouette_coverage(
    solid: Bool[np.ndarray, "r r r"], mask: Bool[np.ndarray, "n h w"], rig: UnitFrameCameras
) -> float:
    """Share of the silhouettes' pixels that show a cell of `solid`; 1 if the masks are empty.

    Counted on images about as coarse as the cells, to within one of their pixels.
    """
    pixel_stride = max(1, round(rig.min_diameter_px / len(solid)))
    masks = mask[:, pixel_stride // 2 :: pixel_stride, pixel_stride // 2 :: pixel_stride]
    cells = np.stack(np.unravel_index(surface_voxels(solid.astype(np.uint8)), solid.shape), axis=1)
    points = ((cells + 0.5) * (2 / len(solid)) - 1).astype(np.float32)
    covered = sum(
        (masks[view] & visible_pixels(points, projection, masks[view].shape, pixel_stride)).sum()
        for view, projection in enumerate(rig.projection)
    )
    return float(covered / masks.sum()) if masks.any() else 1.0


def visible_pixels(
    points: Float32[np.ndarray, "m 3"],
    projection: Float32[np.ndarray, "3 4"],
    shape: tuple[int, int],
    pixel_stride: int,
) -> Bool[np.ndarray, "h w"]:
    """Pixels of `pixel_stride` px that a point projects into, or into a neighbor of."""
    u, v, depth = projection[:, :3] @ points.T + projection[:, 3:]
    column, row = (
        np.floor(coordinate / depth / pixel_stride).astype(np.int64) for coordinate in (u, v)
    )
    in_frame = (row >= 0) & (row < shape[0]) & (column >= 0) & (column < shape[1]) & (depth > 0)
    image = np.zeros(shape, bool)
    image[row[in_frame], column[in_frame]] = True
    return maximum_filter(image, 3)
