"""What all views together show in the plane of a face: the face, and the mouths in it.

Under distant lights a plane face has one brightness, from wherever it is seen, and so has a label
on it.  Through a mouth in it views see walls and floors, whose brightness differs with the view.
So each point of the plane is looked up in all views that face it and that nothing hides it from.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Float32, Float64
from scipy.ndimage import (
    binary_closing,
    binary_dilation,
    binary_erosion,
    binary_fill_holes,
    distance_transform_edt,
    gaussian_filter,
    label,
    map_coordinates,
)

from industnerf.methods.industnerf_plus.faces import Face
from industnerf.methods.industnerf_plus.trials import PIXEL_STEP, Trials

RASTER = 0.75  # cells
BELOW = 1.5  # cells under the plane, where the hull tells whether there is a face
MIN_POINTS = 30
MIN_FACING = 0.2  # cosine between the normal and the direction to a camera
HIDING = 3.0  # cells before the plane; matter there hides it
AT_PLANE = 0.8  # cells of the surface from the plane, where the face's brightness is looked up
NEAR_PLANE = 2.5  # cells; the surface may be so far off its face
TOLERANCE = 0.035  # of the brightest normal's brightness, within which a face has one
MIN_TOLERANCE = 0.008  # two steps of 8 bits
BRIGHTNESS_BINS = 200
MIN_EVEN_SHARE = 0.5  # of what is seen of a face has its brightness
OTHER_SHARE = 0.2  # of the views see something else: no face
SMOOTHING = 0.7  # entries
MIN_MOUTH = 12.0  # square cells
MOUTH_OPENING, GAP_OPENING = 1, 2  # entries; narrower necks part two mouths
MIN_RIM_SHARE = 0.6  # of what is about a mouth is face
MIN_DISC_OVERLAP = 0.8  # of a mouth and a disc of its area; such a mouth is round
MATTER_STEP = 2  # nodes


@dataclass(frozen=True)
class FaceMap:
    """Raster of the plane of a face; entry (0, 0) is at `corner` (cells) along `axes`."""

    face: Face
    axes: Float[np.ndarray, "2 3"]
    corner: Float[np.ndarray, "2"]
    is_section: Bool[np.ndarray, "u v"]  # inside the hull
    is_gap: Bool[np.ndarray, "u v"]  # outside of it, but there is matter farther down
    is_face: Bool[np.ndarray, "u v"]  # there is surface, and it looks like the face
    other_share: Float[np.ndarray, "u v"]  # of the views that see something else than most do

    def points(self, mask: Bool[np.ndarray, "u v"]) -> Float[np.ndarray, "n 3"]:
        """Points (cells) of the plane, where `mask` is."""
        return _plane_points(self.face, self.axes, self.corner, np.argwhere(mask))

    def look_up(
        self, values: Float32[np.ndarray, "u v"], points: Float32[np.ndarray, "n 3"]
    ) -> Float32[np.ndarray, "n"]:
        """`values` of the raster at the feet of `points`; far outside where the raster ends."""
        entries = (points @ self.axes.T.astype(np.float32) - self.corner.astype(np.float32)) / (
            np.float32(RASTER)
        )
        return map_coordinates(values, entries.T, order=1, cval=-9.0)

    def height(self, points: Float32[np.ndarray, "n 3"]) -> Float32[np.ndarray, "n"]:
        """Above the plane, in cells."""
        return points @ self.face.normal.astype(np.float32) - np.float32(self.face.offset)

    def mouths(self) -> list[Float32[np.ndarray, "u v"]]:
        """Openings in the face: distances to their borders (cells, > 0 inside)."""
        is_other = gaussian_filter(self.other_share, SMOOTHING) > OTHER_SHARE
        mask = binary_fill_holes(is_other & self.is_section) & self.is_section
        return [_round_outline(mouth) for mouth in self._parted(mask, MOUTH_OPENING)]

    def gaps(self) -> list[Float32[np.ndarray, "u v"]]:
        """What is open beside the face, as `mouths`: grooves that reach its border."""
        return [_outline(gap) for gap in self._parted(self.is_gap, GAP_OPENING)]

    def _parted(self, mask: Bool[np.ndarray, "u v"], opening: int) -> list[Bool[np.ndarray, "u v"]]:
        """Connected parts with a rim of face, the largest first."""
        labels, number = label(binary_erosion(mask, iterations=opening))
        parts = []
        for k in range(1, number + 1):
            part = binary_dilation(labels == k, iterations=opening + 1) & mask
            if part.sum() * RASTER**2 < MIN_MOUTH or not binary_erosion(part, iterations=2).any():
                continue
            rim = binary_dilation(part, iterations=4) & ~binary_dilation(part) & self.is_section
            if rim.any() and self.is_face[rim].mean() > MIN_RIM_SHARE:
                parts.append(part)
        return sorted(parts, key=lambda part: -part.sum())


def _outline(mask: Bool[np.ndarray, "u v"]) -> Float32[np.ndarray, "u v"]:
    inside, outside = distance_transform_edt(mask), distance_transform_edt(~mask)
    return (RASTER * np.where(mask, inside - 0.5, 0.5 - outside)).astype(np.float32)


def _round_outline(mask: Bool[np.ndarray, "u v"]) -> Float32[np.ndarray, "u v"]:
    """Of a mouth that nearly is a disc that of the disc, which no raster roughens."""
    center = np.argwhere(mask).mean(axis=0)
    away = np.linalg.norm(np.indices(mask.shape) - center[:, None, None], axis=0)
    disc = np.sqrt(mask.sum() / np.pi) - away
    overlap = (mask & (disc > 0)).sum() / (mask | (disc > 0)).sum()
    return (RASTER * disc).astype(np.float32) if overlap > MIN_DISC_OVERLAP else _outline(mask)


def map_face(
    trials: Trials, face: Face, ends: Float32[np.ndarray, "views h w"], tolerance: float
) -> FaceMap | None:
    """The map of a face; None where no single brightness is seen at its plane.

    `ends` are those of `end_lattice`; `tolerance` is of brightness.
    """
    size = np.array(trials.distance.shape)
    axes, corner, shape = _raster(face, size)
    entries = np.argwhere(np.ones(shape, bool))
    points = _plane_points(face, axes, corner, entries)
    below = points - BELOW * face.normal
    is_in_grid = ((below >= 2) & (below <= size - 3)).all(axis=1)
    hull = map_coordinates(trials.surface.grid.hull, below.T, order=1, cval=9.0)
    is_section = is_in_grid & (hull < -0.5)
    if np.count_nonzero(is_section) < MIN_POINTS:
        return None
    points = points[is_section]
    gray, weight = _look_up_views(trials, face, points, ends)
    distance = np.abs(map_coordinates(trials.distance, points.T, order=1))
    is_at_plane = distance < AT_PLANE
    level = _even_level(gray[:, is_at_plane], weight[:, is_at_plane], tolerance)
    if level is None:
        return None
    other_share, is_face = np.zeros(len(entries)), np.zeros(len(entries), bool)
    other_share[is_section] = _other_share(gray, weight, _median_levels(gray, weight), tolerance)
    is_like_face = _other_share(gray, weight, level, tolerance) < OTHER_SHARE
    is_face[is_section] = (distance < NEAR_PLANE) & (weight > 0).any(axis=0) & is_like_face
    matter = _matter_below(trials, face, axes, corner, shape)
    return FaceMap(
        face,
        axes,
        corner,
        is_section.reshape(shape),
        (is_in_grid & ~is_section).reshape(shape) & matter,
        is_face.reshape(shape),
        other_share.reshape(shape),
    )


def end_lattice(trials: Trials) -> Float32[np.ndarray, "views h w"]:
    """How far the rays of every PIXEL_STEPth pixel go (cells); < 0: not known."""
    ends = np.full(trials.lattice_shape, -1, np.float32)
    ends[trials.lattice_index] = trials.ends
    return ends


def _raster(face: Face, size: np.ndarray):
    """Two axes, the corner, and the shape of a raster of the plane over the whole grid."""
    first = np.cross(face.normal, np.eye(3)[np.abs(face.normal).argmin()])
    first /= np.linalg.norm(first)
    axes = np.array([first, np.cross(face.normal, first)])
    corners = np.array([*np.ndindex(2, 2, 2)]) * (size - 1) @ axes.T
    corner = np.floor(corners.min(axis=0))
    return axes, corner, tuple((np.ptp(corners, axis=0) / RASTER).astype(int) + 2)


def _plane_points(face: Face, axes, corner, entries) -> Float64[np.ndarray, "n 3"]:
    return (corner + RASTER * entries) @ axes + face.offset * face.normal


def _look_up_views(trials: Trials, face: Face, points: Float64[np.ndarray, "n 3"], ends):
    """Brightness (v, n) of the pixels that show the points, -1: background; and their weights.

    A view counts by the cosine that it faces the plane with; 0 where matter before the plane
    hides it.
    """
    rays, pictures = trials.rays, trials.pictures
    above = rays.centers @ face.normal - face.offset
    views = np.flatnonzero(above > 0)
    gray, weight = np.zeros((len(views), len(points))), np.zeros((len(views), len(points)))
    for i, view in enumerate(views):
        distance = np.linalg.norm(rays.centers[view] - points, axis=1)
        facing = above[view] / distance
        pixel, is_in_frame = rays.project(points, np.full(len(points), view))
        pixel = pixel.astype(np.int32)
        row, column = np.divmod(pixel % (rays.height * rays.width), rays.width)
        end = ends[view, row // PIXEL_STEP, column // PIXEL_STEP]
        is_hidden = (end >= 0) & (end < distance - HIDING - BELOW / np.maximum(facing, 1e-3))
        is_used = is_in_frame & (facing > MIN_FACING) & ~is_hidden
        gray[i] = np.where(pictures.is_inside(pixel), pictures.gray[pixel], -1.0)
        weight[i] = np.where(is_used, facing, 0.0)
    return gray, weight


def _even_level(gray, weight, tolerance: float) -> float | None:
    """The brightness that most of the weight is within `tolerance` of."""
    is_used = (weight > 0) & (gray >= 0)
    gray, weight = gray[is_used], weight[is_used]
    if not len(gray):
        return None
    bins = (gray * BRIGHTNESS_BINS).astype(int)
    counts = np.bincount(bins, weight, minlength=BRIGHTNESS_BINS + 1)
    peak = np.convolve(counts, [0.5, 1, 1, 1, 0.5], "same").argmax()
    level = float(np.median(gray[np.abs(gray - (peak + 0.5) / BRIGHTNESS_BINS) < tolerance]))
    even = weight[np.abs(gray - level) < tolerance].sum()
    return level if even > MIN_EVEN_SHARE * weight.sum() else None


def _median_levels(gray, weight) -> Float[np.ndarray, "n"]:
    """The median brightness of each point, over the views that see it."""
    is_used = weight > 0
    ordered = np.sort(np.where(is_used, gray, np.inf).T, axis=1)
    middle = np.maximum(is_used.sum(axis=0) - 1, 0) // 2
    return ordered[np.arange(len(middle)), middle]


def _other_share(gray, weight, level, tolerance: float) -> Float[np.ndarray, "n"]:
    """The share of its views in which a point is not at this level."""
    with np.errstate(invalid="ignore"):  # what no view sees has no level
        is_other = np.abs(gray - level) > tolerance
    return (weight * is_other).sum(axis=0) / np.maximum(weight.sum(axis=0), 1e-9)


def _matter_below(trials: Trials, face: Face, axes, corner, shape) -> Bool[np.ndarray, "u v"]:
    """Entries under which, along the normal, any node is solid."""
    step = MATTER_STEP
    nodes = np.argwhere(trials.distance[::step, ::step, ::step] < 0) * step
    nodes = nodes[nodes @ face.normal < face.offset - 2]
    mask = np.zeros(shape, bool)
    entries = np.rint((nodes @ axes.T - corner) / RASTER).astype(int)
    mask[tuple(np.clip(entries, 0, np.array(shape) - 1).T)] = True
    return binary_closing(mask, iterations=3)
