"""How much of the silhouettes a solid fills: all of them, if it is the part's."""

import numpy as np
from jaxtyping import Bool, Float32
from scipy.ndimage import maximum_filter

from industnerf.photohull.space_carving import surface_voxels
from industnerf.photohull.voxel_grid import UnitFrameCameras


def silhouette_coverage(
    solid: Bool[np.ndarray, "r r r"], mask: Bool[np.ndarray, "n h w"], rig: UnitFrameCameras
) -> float:
    """Share of the silhouettes' pixels that show a cell of `solid`; 1 if there is none to fill.

    Of images about as coarse as the cells, and to within one of their pixels.
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
    """The pixels, `coarse` px wide, in or beside which one of the points is."""
    u, v, depth = projection[:, :3] @ points.T + projection[:, 3:]
    column, row = (
        np.floor(coordinate / depth / pixel_stride).astype(np.int64) for coordinate in (u, v)
    )
    in_frame = (row >= 0) & (row < shape[0]) & (column >= 0) & (column < shape[1]) & (depth > 0)
    image = np.zeros(shape, bool)
    image[row[in_frame], column[in_frame]] = True
    return maximum_filter(image, 3)
