"""How much of the silhouettes a solid fills: all of them, if it is the part's."""

import numpy as np
from jaxtyping import Bool, Float32
from scipy.ndimage import maximum_filter

from industnerf.photohull.lattice import Rig
from industnerf.photohull.sweeps import exposed


def filled(solid: Bool[np.ndarray, "r r r"], mask: Bool[np.ndarray, "n h w"], rig: Rig) -> float:
    """Share of the silhouettes' pixels that show a cell of `solid`; 1 if there is none to fill.

    Of images about as coarse as the cells, and to within one of their pixels.
    """
    coarse = max(1, round(rig.px_across / len(solid)))
    wanted = mask[:, coarse // 2 :: coarse, coarse // 2 :: coarse]
    cells = np.stack(np.unravel_index(exposed(solid.astype(np.uint8)), solid.shape), axis=1)
    points = ((cells + 0.5) * (2 / len(solid)) - 1).astype(np.float32)
    found = sum(
        (wanted[view] & shown(points, projection, wanted[view].shape, coarse)).sum()
        for view, projection in enumerate(rig.projection)
    )
    return float(found / wanted.sum()) if wanted.any() else 1.0


def shown(
    points: Float32[np.ndarray, "m 3"],
    projection: Float32[np.ndarray, "3 4"],
    shape: tuple[int, int],
    coarse: int,
) -> Bool[np.ndarray, "h w"]:
    """The pixels, `coarse` px wide, in or beside which one of the points is."""
    u, v, depth = projection[:, :3] @ points.T + projection[:, 3:]
    column, row = (np.floor(at / depth / coarse).astype(np.int64) for at in (u, v))
    framed = (row >= 0) & (row < shape[0]) & (column >= 0) & (column < shape[1]) & (depth > 0)
    image = np.zeros(shape, bool)
    image[row[framed], column[framed]] = True
    return maximum_filter(image, 3)
