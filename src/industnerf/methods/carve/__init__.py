"""Space carving: the surface of the photo hull, `industnerf.photohull`."""

import numpy as np
from jaxtyping import Bool, Float, Float32
from scipy.ndimage import gaussian_filter

from industnerf.errors import ReconstructionFailed
from industnerf.geometry.isosurface import isosurface_points
from industnerf.geometry.silhouettes import outlines, part_in
from industnerf.methods.base import Given, Input, Method, Reconstruction, Scope
from industnerf.photohull import Carved, carved, remarks
from industnerf.photohull.lattice import rig_of
from industnerf.schema import CarveSettings

BLUR = 1.0  # cells; standard deviation that smooths the stairs of what was carved
SHOWN = 0.3  # cells that the last consistent cell stands out, like a pixel that is touched
RIM = 4  # cells kept about the hull; the blur's kernel ends there


def reconstruct(given: Given, settings: CarveSettings, state: None, seed: int) -> Reconstruction:
    """Area-uniform points on the surface of the photo hull.

    Raises ReconstructionFailed if silhouettes or photographs leave nothing.
    """
    rig = rig_of(given.cameras)
    mask = part_in(given.rgb, given.background, settings.tolerance)
    cells = carved(outlines(mask), given.rgb, rig, settings)
    if not cells.hull.any():
        raise ReconstructionFailed(
            f"no volume: the silhouettes of {len(mask)} views have none in common, not one of "
            f"{settings.grid_res}^3 cells; a pixel is of the part where it differs from the "
            "background by more than method.carve.tolerance"
        )
    points = surface_points(cells, settings.points, np.random.default_rng(seed))
    if not len(points):
        raise ReconstructionFailed(
            f"no surface: of {cells.hull.sum()} cells {cells.left.sum()} are left; a larger "
            "method.carve.threshold takes less off"
        )
    said = remarks(cells, settings, "the answer is the visual hull")
    return Reconstruction(rig.centre + rig.radius_mm * points, remarks=said)


def surface_points(cells: Carved, count: int, rng: np.random.Generator) -> Float[np.ndarray, "_ 3"]:
    """Points in the unit frame: on the hull where nothing was carved, else on a smooth surface."""
    occupied = [np.flatnonzero(cells.hull.any(axis=a)) for a in ((1, 2), (0, 2), (0, 1))]
    first = np.array([max(0, at[0] - RIM) for at in occupied])
    box = tuple(slice(a, at[-1] + 1 + RIM) for a, at in zip(first, occupied, strict=True))
    values = np.minimum(cells.depth[box], depth_in_rest(cells.hull[box], cells.left[box]))
    spacing = 2 / len(cells.depth)
    return isosurface_points(values, 0.0, (first + 0.5) * spacing - 1, spacing, count, rng)


def depth_in_rest(
    hull: Bool[np.ndarray, "a b c"], left: Bool[np.ndarray, "a b c"]
) -> Float32[np.ndarray, "a b c"]:
    """Signed distance (cells) from what was carved, about right near its surface.

    The share of the hull about a cell that was carved; across a flat surface it falls as the
    normal distribution does, with the slope 1 / (BLUR sqrt(2 pi)).  As a share of the hull
    alone, it does not end where the hull does, and leaves no skin there.
    """
    carved, all_ = (
        gaussian_filter(some.astype(np.float32), BLUR, truncate=RIM)
        for some in (hull & ~left, hull)
    )
    share = carved / np.maximum(all_, np.float32(1e-6))
    depth = (0.5 - share) * np.float32(BLUR * np.sqrt(2 * np.pi)) - np.float32(SHOWN)
    return np.where(carved > 1e-3, depth, np.float32(RIM))


METHODS = {
    "carve": Method(
        "carve",
        Scope.PART,
        frozenset({Input.RGB, Input.BACKGROUND}),
        reconstruct,
        random=True,
    )
}
