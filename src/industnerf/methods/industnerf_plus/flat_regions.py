"""Regions of like brightness in the pictures: faces of one normal, seen whole or in part.

Under distant lights a plane has one brightness wherever it lies, so where a region shows one
plane, nothing is in front of that plane along the rays of its pixels, and matter is behind it.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Float32, Int32
from scipy.ndimage import (
    distance_transform_edt,
    find_objects,
    label,
    map_coordinates,
    maximum_filter,
    minimum_filter,
)

from industnerf.methods.industnerf_plus.pictures import Pictures
from industnerf.methods.industnerf_plus.shaded_surface import PinholeRays

FLAT_CONTRAST = 3 / 255  # of brightness, within one pixel
MAX_SPREAD = 0.006  # standard deviation; more is a curved face
MIN_PIXELS = 30
MARGIN = 5  # px about a region whose distances are kept
BORDER = 1.0  # px; pixels at the border of a region mix in what is beside it
NUM_SAMPLES = 120
MIN_TRIPLE_AREA = 10.0  # square cells, twice that of the triangle
LOW_QUANTILE = 0.02  # of the offsets of the hits: an emptied region touches its plane there
NORMAL_CONE_DEG, NORMAL_SPACING_DEG, MAX_NORMALS = 6.0, 14.0, 10
MIN_NORMAL_SHARE = 0.015
SAME_NORMAL_DEG, SAME_OFFSET = 3.0, 0.7  # degrees, cells; nearer planes are one
MIN_INLIERS, MIN_INLIER_SHARE = 10, 0.2


@dataclass(frozen=True)
class FlatRegion:
    """Connected pixels of one view, and the brightness they share."""

    view: int
    corner: tuple[int, int]  # row and column of the first entry of `inside_px`
    inside_px: Float32[np.ndarray, "h w"]  # distance to the region's border, > 0 inside
    brightness: float
    num_pixels: int
    samples: Int32[np.ndarray, "n"]  # flat indices of some of its pixels

    def inside(
        self, rays: PinholeRays, points: Float32[np.ndarray, "n 3"]
    ) -> Float32[np.ndarray, "n"]:
        """Distances of points to the sides of the cone of the region's rays, > 0 inside (cells).

        Beyond MARGIN pixels from the region they are cut off.
        """
        to_ray = rays.pixel_to_ray[self.view]
        offsets = points - rays.centers[self.view].astype(np.float32)
        image = offsets @ np.linalg.inv(to_ray).T.astype(np.float32)
        depth = image[:, 2]
        row = image[:, 1] / depth - np.float32(0.5 + self.corner[0])
        column = image[:, 0] / depth - np.float32(0.5 + self.corner[1])
        inside_px = map_coordinates(self.inside_px, [row, column], order=1, mode="nearest")
        return inside_px * depth * np.float32(np.linalg.norm(to_ray[:, 0]))


def flat_regions(rays: PinholeRays, pictures: Pictures) -> list[FlatRegion]:
    """The regions of all views, in the order of their pixels."""
    shape = (len(rays.centers), rays.height, rays.width)
    gray = pictures.gray.reshape(shape)
    pixels = np.arange(gray.size, dtype=np.int32)
    is_inside = pictures.is_inside(pixels).reshape(shape)
    regions = []
    for view, (image, inside) in enumerate(zip(gray, is_inside, strict=True)):
        regions.extend(_of_view(view, image, inside))
    return regions


def _of_view(
    view: int, image: Float32[np.ndarray, "h w"], is_inside: np.ndarray
) -> list[FlatRegion]:
    contrast = maximum_filter(image, 3) - minimum_filter(image, 3)
    labels, _ = label((contrast <= FLAT_CONTRAST + 1e-6) & is_inside)
    counts = np.bincount(labels.ravel())
    boxes = find_objects(labels)
    regions = []
    for number in np.flatnonzero(counts[1:] >= MIN_PIXELS) + 1:
        box = boxes[number - 1]
        mask = labels[box] == number
        values = image[box][mask]
        if values.std() > MAX_SPREAD:
            continue
        rows, columns = np.nonzero(mask)
        top, left = box[0].start, box[1].start
        flat = (view * image.shape[0] + rows + top) * image.shape[1] + columns + left
        regions.append(
            FlatRegion(
                view,
                (top - MARGIN, left - MARGIN),
                _inside_px(np.pad(mask, MARGIN)),
                float(np.median(values)),
                len(flat),
                flat[:: max(1, len(flat) // NUM_SAMPLES)].astype(np.int32),
            )
        )
    return regions


def _inside_px(mask: np.ndarray) -> Float32[np.ndarray, "h w"]:
    inside = distance_transform_edt(mask) - 0.5
    outside = distance_transform_edt(~mask) - 0.5
    return (np.where(mask, inside, -outside) + BORDER).astype(np.float32)


def plane_through(
    points: Float[np.ndarray, "n 3"],
    weights: Float[np.ndarray, "n"],
    is_candidate: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]],
    rng: np.random.Generator,
    num_trials: int,
    tolerance: float,
) -> tuple[Float[np.ndarray, "3"], float] | None:
    """Normal and offset of the plane with most weight within `tolerance`, by random triples.

    Source: RANSAC -- Fischler and Bolles (1981).  `is_candidate` maps normals (m, 3) to flags, and
    turns them to its side first; None where it likes no plane through a fifth of the points.
    """
    a, b, c = points[rng.integers(0, len(points), (num_trials, 3))].transpose(1, 0, 2)
    normals = np.cross(b - a, c - a)
    area = np.linalg.norm(normals, axis=1)
    is_wide = area > MIN_TRIPLE_AREA
    normals, a = normals[is_wide] / area[is_wide, None], a[is_wide]
    normals, is_good = is_candidate(normals)
    normals, a = normals[is_good], a[is_good]
    if not len(normals):
        return None
    offsets = (normals * a).sum(axis=1)
    is_near = np.abs(normals @ points.T - offsets[:, None]) < tolerance
    best = int((is_near * weights).sum(axis=1).argmax())
    inliers = points[is_near[best]]
    if len(inliers) < max(MIN_INLIERS, MIN_INLIER_SHARE * len(points)):
        return None
    mean = inliers.mean(axis=0)
    normal = np.linalg.svd(inliers - mean, full_matrices=False)[2][2]
    normals, is_good = is_candidate((normal * np.sign(normal @ normals[best]))[None])
    return (normals[0], float(mean @ normals[0])) if is_good[0] else None


def likely_offsets(offsets: Float[np.ndarray, "n"], weights: Float[np.ndarray, "n"]) -> list[float]:
    """Offsets of a plane by those of the hits: where they touch it, and where most of them are."""
    low = float(np.quantile(offsets, LOW_QUANTILE))
    cell = np.floor(offsets - offsets.min()).astype(int)
    counts = np.convolve(np.bincount(cell, weights), [1, 1])
    is_near = np.abs(offsets - offsets.min() - counts.argmax()) < 1
    mode = float(np.median(offsets[is_near])) if is_near.any() else low
    return [low] if abs(mode - low) < SAME_OFFSET else [low, mode]


def frequent_normals(normals: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "k 3"]:
    """Modes of the normals, each the mean of those within a narrowing cone."""
    sample = normals[:: max(1, len(normals) // 6000)]
    left = np.ones(len(sample), bool)
    modes: list[np.ndarray] = []
    while left.any() and len(modes) < MAX_NORMALS:
        rest = sample[left]
        trial = rest[:: max(1, len(rest) // 250)]
        counts = (trial @ rest.T > cosine(NORMAL_CONE_DEG)).sum(axis=1)
        if counts.max() < MIN_NORMAL_SHARE * len(sample):
            break
        mode = trial[counts.argmax()]
        for share in (1.0, 0.67, 0.42, 0.42):
            mode = rest[rest @ mode > cosine(share * NORMAL_CONE_DEG)].sum(axis=0)
            mode = mode / np.linalg.norm(mode)
        modes.append(mode)
        left &= sample @ mode < cosine(NORMAL_SPACING_DEG)
    return np.array(modes).reshape(-1, 3)


def cosine(degrees: float) -> float:
    return float(np.cos(np.radians(degrees)))


def is_same_plane(a: tuple[np.ndarray, float], b: tuple[np.ndarray, float]) -> bool:
    """Whether two planes differ by less than what surfaces are off anyway."""
    return bool(a[0] @ b[0] > cosine(SAME_NORMAL_DEG) and abs(a[1] - b[1]) < SAME_OFFSET)
