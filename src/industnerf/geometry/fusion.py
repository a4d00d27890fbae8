"""Depth images, and the mean of the signed distances that they give.

Curless and Levoy, "A Volumetric Method for Building Complex Models from Range Images" (1996).
Unit frame: the region of interest is the ball of radius 1 about the origin, and the lattice
tiles the cube around it.  Depths and distances are in that unit, distances positive inside.
"""

import numpy as np
from jaxtyping import Bool, Float32, Int32, Num
from scipy.ndimage import binary_dilation, minimum_filter

AT_ONCE = 1 << 16  # cells looked at together, so that their arrays stay in the cache
BEHIND = 0.5  # truncations behind a surface, from where on an image knows nothing
OUTLINE = 3  # px; within this square about a pixel, the part may cover what its centre does not
STEEP = np.float32(1e6)  # depth of the background where slopes are measured: larger than any
UNKNOWN = np.float32(-1.0)  # depth of a pixel of which nothing is known


class Image:
    """A depth image, 0 where it shows the background, and what is read from it.

    Where it is UNKNOWN, and a pixel beside, it says nothing of what is empty.
    """

    def __init__(
        self, depth: Float32[np.ndarray, "h w"], projection: Float32[np.ndarray, "3 4"]
    ) -> None:
        shown = depth > 0
        self._projection, self._size = projection, depth.shape
        beyond = np.where(depth < 0, np.float32(-np.inf), np.float32(np.inf))
        self._depth = np.where(shown, depth, beyond).ravel()
        self._least = minimum_filter(self._depth.reshape(depth.shape), OUTLINE).ravel()
        pixel = np.where(shown, depth, STEEP) / focal_of(projection)  # what it spans
        slope = slopes(np.where(shown, depth, STEEP)) / pixel
        self._cosine = (shown / np.sqrt(1 + slope**2)).astype(np.float32).ravel()

    def empty(self, points: Float32[np.ndarray, "n 3"], truncation: float) -> Bool[np.ndarray, "n"]:
        """Whether a point is in front of all that is about its pixel."""
        at, framed, depth = self._pixel(points)
        return framed & (self._least[at] - depth > truncation)

    def look(
        self, points: Float32[np.ndarray, "n 3"], truncation: float
    ) -> tuple[Float32[np.ndarray, "n"], Float32[np.ndarray, "n"]]:
        """Truncated signed distances from the tangent planes, and their weights.

        Along a slanted ray a distance is longer; cut off outside and left out inside, such would
        draw the surface inwards.  The weight is the cosine between ray and normal, and fades
        to 0 behind what is seen: an image knows nothing of there, and would push out the far
        side of a thin wall.
        """
        at, framed, depth = self._pixel(points)
        cosine = self._cosine[at]
        behind = np.where(cosine > 0, depth - self._depth[at], 0) * cosine
        faded = 2 - 2 * behind / np.float32(BEHIND * truncation)
        weight = cosine * framed * np.clip(faded, 0, 1)
        return np.maximum(behind, -np.float32(truncation)), weight

    def _pixel(
        self, points: Float32[np.ndarray, "n 3"]
    ) -> tuple[Int32[np.ndarray, "n"], Bool[np.ndarray, "n"], Float32[np.ndarray, "n"]]:
        """The pixel that shows each point, whether there is one, and the point's depth."""
        u, v, depth = self._projection[:, :3] @ points.T + self._projection[:, 3:]
        column, row = (u / depth).astype(np.int32), (v / depth).astype(np.int32)
        height, width = self._size
        framed = (depth > 0) & (u >= 0) & (column < width) & (v >= 0) & (row < height)
        return np.where(framed, row * width + column, 0), framed, depth


def focal_of(projection: Float32[np.ndarray, "3 4"]) -> float:
    """Of u = (f x + c z) / z: the part of u's row that is across the axis, in px."""
    across = np.cross(projection[0, :3], projection[2, :3])
    return float(np.linalg.norm(across) / np.linalg.norm(projection[2, :3]) ** 2)


def slopes(depth: Float32[np.ndarray, "h w"]) -> Float32[np.ndarray, "h w"]:
    """How fast `depth` changes, per pixel: on the flatter side of each, for an edge ends one."""
    squared = np.zeros_like(depth)
    for along in (depth, depth.T):
        change = np.abs(np.diff(along, axis=0, prepend=2 * STEEP, append=2 * STEEP))
        flatter = np.minimum(change[1:], change[:-1])
        squared += (flatter if along is depth else flatter.T) ** 2
    return np.sqrt(squared)


def fuse(
    depth: Float32[np.ndarray, "n h w"],
    projection: Float32[np.ndarray, "n 3 4"],
    grid_res: int,
    truncation: float,
) -> Float32[np.ndarray, "r r r"]:
    """Signed distance at the centre of every cell: `truncation` where nothing is seen.

    What is seen empty is outside; beside the rest it keeps its distance, or the surface would
    be drawn inwards by all views that look past it.
    """
    images = [Image(*one) for one in zip(depth, projection, strict=True) if one[0].any()]
    shape = (grid_res,) * 3
    left = np.concatenate([not_empty(at, grid_res, images, truncation) for at in range(grid_res)])
    solid = left.reshape(shape)
    near = np.flatnonzero(binary_dilation(solid, np.ones((3, 3, 3), bool)))
    values = np.full(grid_res**3, -truncation, np.float32)
    for at in range(0, len(near), AT_ONCE):
        cells = near[at : at + AT_ONCE]
        place = np.stack(np.unravel_index(cells, shape), axis=1)
        mean = mean_distance(centres(place, grid_res), images, truncation)
        values[cells] = np.where(left[cells] | (mean < 0), mean, -np.float32(truncation))
    return values.reshape(shape)


def centres(cells: Num[np.ndarray, "n 3"], grid_res: int) -> Float32[np.ndarray, "n 3"]:
    """In the unit frame."""
    return ((cells + 0.5) * (2 / grid_res) - 1).astype(np.float32)


def not_empty(
    plane: int, grid_res: int, images: list[Image], truncation: float
) -> Bool[np.ndarray, "n"]:
    """Which cells of a plane of the lattice no image sees empty."""
    cells = np.indices((1, grid_res, grid_res)).reshape(3, -1).T
    cells[:, 0] = plane
    points, left = centres(cells, grid_res), np.arange(len(cells))
    for image in images:
        left = left[~image.empty(points[left], truncation)]
    return np.isin(np.arange(len(cells)), left)


def mean_distance(
    points: Float32[np.ndarray, "n 3"], images: list[Image], truncation: float
) -> Float32[np.ndarray, "n"]:
    """Mean over the images, by weight; `truncation` where none has any."""
    total, weights = np.zeros((2, len(points)), np.float32)
    for image in images:
        distance, weight = image.look(points, truncation)
        total += weight * distance
        weights += weight
    unseen = weights == 0
    return np.where(unseen, np.float32(truncation), total / np.where(unseen, 1, weights))
