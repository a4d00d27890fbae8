"""Space carving: the surface of the photo hull, `industnerf.photohull`."""

import numpy as np
from jaxtyping import Bool, Float, Float32
from scipy.ndimage import gaussian_filter

from industnerf.errors import ReconstructionFailed
from industnerf.geometry.isosurface import isosurface_points
from industnerf.geometry.silhouettes import foreground_mask, silhouette_distances
from industnerf.methods.base import Input, Method, MethodInputs, Reconstruction, Scope
from industnerf.photohull import CarvingResult, carve_space, carving_warnings
from industnerf.photohull.voxel_grid import unit_frame_cameras
from industnerf.schema import CarveSettings

BLUR = 1.0  # cells; standard deviation that smooths the stairs of what was carved
SURFACE_OFFSET = 0.3  # cells that the last consistent cell stands out, see BOUNDARY_OFFSET_PX
PADDING = 4  # cells kept about the hull; the blur's kernel ends there


def reconstruct(
    inputs: MethodInputs, settings: CarveSettings, state: None, seed: int
) -> Reconstruction:
    """Area-uniform points on the surface of the photo hull.

    Raises ReconstructionFailed if silhouettes or photographs leave nothing.
    """
    rig = unit_frame_cameras(inputs.cameras)
    mask = foreground_mask(inputs.rgb, inputs.background, settings.background_tolerance)
    result = carve_space(silhouette_distances(mask), inputs.rgb, rig, settings)
    if not result.hull.any():
        raise ReconstructionFailed(
            f"no volume: the silhouettes of {len(mask)} views have none in common, not one of "
            f"{settings.grid_res}^3 cells; a pixel is of the part where it differs from the "
            "background by more than method.carve.background_tolerance"
        )
    points = surface_points(result, settings.points, np.random.default_rng(seed))
    if not len(points):
        raise ReconstructionFailed(
            f"no surface: of {result.hull.sum()} cells {result.solid.sum()} are left; a larger "
            "method.carve.color_threshold takes less off"
        )
    messages = carving_warnings(result, settings, "the result is the visual hull")
    return Reconstruction(rig.center + rig.radius_mm * points, warnings=messages)


def surface_points(
    result: CarvingResult, count: int, rng: np.random.Generator
) -> Float[np.ndarray, "_ 3"]:
    """Points in the unit frame: on the hull where nothing was carved, else on a smooth surface."""
    occupied = [np.flatnonzero(result.hull.any(axis=a)) for a in ((1, 2), (0, 2), (0, 1))]
    lower = np.array([max(0, at[0] - PADDING) for at in occupied])
    crop = tuple(slice(a, at[-1] + 1 + PADDING) for a, at in zip(lower, occupied, strict=True))
    values = np.minimum(result.depth[crop], depth_in_carved(result.hull[crop], result.solid[crop]))
    spacing = 2 / len(result.depth)
    return isosurface_points(values, 0.0, (lower + 0.5) * spacing - 1, spacing, count, rng)


def depth_in_carved(
    hull: Bool[np.ndarray, "a b c"], solid: Bool[np.ndarray, "a b c"]
) -> Float32[np.ndarray, "a b c"]:
    """Signed distance (cells) from what was carved, about right near its surface.

    The share of the hull about a cell that was carved; across a flat surface it falls as the
    normal distribution does, with the slope 1 / (BLUR sqrt(2 pi)).  As a share of the hull
    alone, it does not end where the hull does, and leaves no skin there.
    """
    removed, total = (
        gaussian_filter(mask.astype(np.float32), BLUR, truncate=PADDING)
        for mask in (hull & ~solid, hull)
    )
    share = removed / np.maximum(total, np.float32(1e-6))
    depth = (0.5 - share) * np.float32(BLUR * np.sqrt(2 * np.pi)) - np.float32(SURFACE_OFFSET)
    return np.where(removed > 1e-3, depth, np.float32(PADDING))


METHODS = {
    "carve": Method(
        "carve",
        Scope.PART,
        frozenset({Input.RGB, Input.BACKGROUND}),
        reconstruct,
        is_stochastic=True,
    )
}
