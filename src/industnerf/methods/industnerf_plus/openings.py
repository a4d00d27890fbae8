"""Recesses that a soft surface has plugged, and walls it has eaten: put right in discrete steps.

A polish by gradient opens no plug, for inside of one the normals are the plug's own.  So planes
are proposed for the flat regions of the pictures that the surface does not explain: in front of
the plane the cone of the region's rays is emptied, and a slab behind it is filled.  A proposal
stays if all pictures together, rendered anew where it changes them, look more like the
photographs.

A plane looks alike at any depth: a floor between walls that are only seen in part stays too high,
and one of the brightness of its surroundings is not told from them.
"""

from dataclasses import dataclass

import numpy as np
import warp as wp
from jaxtyping import Float, Float32, Int64
from scipy.ndimage import binary_dilation

from industnerf.methods.industnerf_plus import grid_kernels
from industnerf.methods.industnerf_plus.appearance import pixel_lattice
from industnerf.methods.industnerf_plus.distance_grid import band_nodes
from industnerf.methods.industnerf_plus.flat_regions import (
    SAME_OFFSET,
    FlatRegion,
    cosine,
    flat_regions,
    frequent_normals,
    is_same_plane,
    likely_offsets,
    plane_through,
)
from industnerf.methods.industnerf_plus.pictures import Pictures
from industnerf.methods.industnerf_plus.shaded_surface import (
    PinholeRays,
    ShadedSurface,
    launch,
    to_device,
)
from industnerf.schema.industnerf import OpeningSettings

BETA = 0.3  # cells
PIXEL_STEP = 4  # every so many pixels in both directions judge a proposal
EDGE_WEIGHT = 0.3  # of pixels beside edges, where a rim half a cell off already misleads
MAX_RESIDUAL = 0.2
SLAB = 3.0  # cells of matter behind a plane
MATCH = 0.012  # of brightness, between a region and a normal
EXPLAINED_SHARE = 0.8  # of a region's pixels that match within 2 MATCH: nothing to do
AMBIENT_MARGIN = 0.02  # darker regions tell no normal
MAX_FACING = -0.03  # of a ray along a normal
MIN_FLIPS = 6  # nodes that change sides, and pixels that change
MIN_CHANGE = 0.02  # cells
HIT_MARGIN = 0.7  # cells; a soft surface is hit before it is reached
NUM_TRIPLES = 200
NORMAL_MATCH_DEG = 6.0  # nearer normals are one
PLANE_TOLERANCE = 0.6  # cells
MIN_ACCEPTED = 3  # in a round, for another one


@dataclass(frozen=True)
class Plane:
    """n . x = offset, and the box (cells) in which it replaces the surface."""

    normal: Float32[np.ndarray, "3"]
    offset: np.float32
    lo: Int64[np.ndarray, "3"]
    hi: Int64[np.ndarray, "3"]


def open_recesses(
    surface: ShadedSurface,
    rays: PinholeRays,
    pictures: Pictures,
    settings: OpeningSettings,
    seed: int,
) -> int:
    """Change `surface`, whose light is fitted, where the pictures agree; returns how often.

    With several finishes a brightness tells no normal, and nothing is proposed.
    """
    if surface.finishes is None or len(surface.finishes.albedo) > 1:
        return 0
    rng = np.random.default_rng(seed)
    regions = flat_regions(rays, pictures)
    num_inside = np.count_nonzero(pictures.is_inside(np.arange(len(pictures.gray), dtype=np.int32)))
    num_flat = sum(region.num_pixels for region in regions)
    if num_flat <= settings.min_flat_fraction * num_inside:
        return 0
    accepted = 0
    for _ in range(settings.rounds):
        accepted_now = _Round(surface, rays, pictures, settings, rng).run(regions)
        if accepted_now:
            surface.redistance()
        accepted += accepted_now
        if accepted_now < MIN_ACCEPTED:
            break
    return accepted


class _Round:
    """One pass over the regions, those with most to explain first."""

    def __init__(self, surface, rays, pictures, settings, rng) -> None:
        self._surface, self._rays, self._pictures = surface, rays, pictures
        self._settings, self._rng = settings, rng
        self._lighting = surface.finishes.lighting
        self._num_trials = 0
        surface.update_band(BETA)
        self._distance = surface.distance.numpy().copy()
        pixels = pixel_lattice(len(rays.centers), rays.height, rays.width, PIXEL_STEP)
        self._pixels = pixels[pictures.is_inside(pixels)]
        self._weight = np.where(pictures.is_edge(self._pixels), EDGE_WEIGHT, 1.0)
        self._directions = rays.directions(self._pixels).astype(np.float32)
        views = self._pixels // (rays.width * rays.height)
        self._origins = rays.centers.astype(np.float32)[views]
        self._cost, self._hit = self._look(np.arange(len(self._pixels)))
        self._points = self._hit_points(np.arange(len(self._pixels)))
        self._normals = self._candidate_normals()

    def _render(self, pixels):
        rendered = self._surface.render(self._rays, pixels, self._pictures.gray_background, BETA)
        return rendered.color.numpy()[:, 0], rendered.hit.numpy()

    def _look(self, chosen: Int64[np.ndarray, "n"]):
        """Cost and hit of the chosen ones of the judging pixels."""
        color, hit = self._render(self._pixels[chosen])
        residual = np.abs(color - self._pictures.gray[self._pixels[chosen]])
        return self._weight[chosen] * np.minimum(residual, MAX_RESIDUAL), hit.copy()

    def _hit_points(self, chosen: Int64[np.ndarray, "n"]) -> Float32[np.ndarray, "n 3"]:
        hit = self._hit[chosen, None]
        points = self._origins[chosen] + hit * self._directions[chosen]
        return np.where(hit > 0, points, np.float32(-1e3))  # in no box

    def _candidate_normals(self) -> Float[np.ndarray, "k 3"]:
        """Frequent normals of the surface, and their opposites."""
        nodes = band_nodes(self._surface.distance.numpy(), SAME_OFFSET)
        found = frequent_normals(self._surface.normals(nodes.astype(float)))
        has_opposite = (found @ found.T < -cosine(NORMAL_MATCH_DEG)).any(axis=1)
        return np.concatenate([found, -found[~has_opposite]])

    def run(self, regions: list[FlatRegion]) -> int:
        """Try the regions; returns how many proposals stay."""
        residuals = self._residuals(regions)
        order = sorted(range(len(regions)), key=lambda i: (-residuals[i], i))
        accepted = 0
        for i in order:
            if self._num_trials >= self._settings.trials:
                break
            accepted += self._try_region(regions[i])
        return accepted

    def _residuals(self, regions: list[FlatRegion]) -> Float[np.ndarray, "k"]:
        """Sum of the residuals of all pixels of each region, by its samples."""
        color, _ = self._render(np.concatenate([region.samples for region in regions]))
        counts = [len(region.samples) for region in regions]
        parts = np.split(color, np.cumsum(counts)[:-1])
        return np.array(
            [
                region.num_pixels
                * np.minimum(np.abs(part - region.brightness), MAX_RESIDUAL).mean()
                for region, part in zip(regions, parts, strict=True)
            ]
        )

    def _try_region(self, region: FlatRegion) -> bool:
        best_gain, best = 0.0, None
        for plane in self._planes(region):
            gain = self._trial(region, plane, keep=False)
            if gain > best_gain:
                best_gain, best = gain, plane
        return best is not None and self._trial(region, best, keep=True) > 0

    def _planes(self, region: FlatRegion) -> list[Plane]:
        """Planes that would look as bright as the region, through part of its hits or before it."""
        if region.brightness < self._lighting.ambient + AMBIENT_MARGIN:
            return []
        color, hit = self._render(region.samples)
        matches = np.abs(color - region.brightness) < 2 * MATCH
        if matches.mean() > EXPLAINED_SHARE or (hit > 0).mean() < 0.5:
            return []
        points = self._rays.points(region.samples, hit)[hit > 0]
        directions = self._rays.directions(region.samples)[hit > 0]
        # hits of the right brightness more likely are on the plane
        weights = 1.0 + 2.0 * matches[hit > 0]

        def is_candidate(normals):
            normals = normals * -np.sign(normals @ directions.mean(axis=0))[:, None]
            difference = np.abs(self._lighting.brightness(normals) - region.brightness)
            faces = (directions @ normals.T).max(axis=0) < MAX_FACING
            return normals, (difference < MATCH) & faces

        fitted = plane_through(
            points, weights, is_candidate, self._rng, NUM_TRIPLES, PLANE_TOLERANCE
        )
        found = [fitted] if fitted else []
        turned, is_good = is_candidate(self._normals)
        same_side = (turned * self._normals).sum(axis=1) > 0
        for normal in self._normals[is_good & same_side]:
            offsets = points @ normal
            found += [
                (normal, offset)
                for offset in likely_offsets(offsets, weights)
                if not fitted or not is_same_plane(fitted, (normal, offset))
            ]
        return [
            self._plane(points, directions, *plane)
            for plane in found
            if (np.abs(points @ plane[0] - plane[1]) < SAME_OFFSET).mean() < 0.9
        ]

    def _plane(self, points, directions, normal, offset) -> Plane:
        along = np.clip((offset - points @ normal) / (directions @ normal), -60, 200)[:, None]
        corners = np.concatenate([points, points + along * directions])
        lo = np.maximum(np.floor(corners.min(axis=0)).astype(int) - 3, 2)
        shape = np.array(self._surface.grid.hull.shape)
        hi = np.minimum(np.ceil(corners.max(axis=0)).astype(int) + 4, shape - 2)
        return Plane(normal.astype(np.float32), np.float32(offset), lo, hi)

    def _trial(self, region: FlatRegion, plane: Plane, keep: bool) -> float:
        """How much less the pictures cost with the plane in place; 0: not clearly less.

        Some pixels judge it, or all of them, before it stays.
        """
        change = self._change(region, plane)
        if change is None:
            return 0.0
        chosen = self._changed_pixels(region, plane, keep)
        if len(chosen) < MIN_FLIPS:
            return 0.0
        self._num_trials += 1
        nodes, before, after = change
        near = self._gradient_nodes(plane, nodes[np.abs(after) < BETA * 4 + 2])
        self._set(nodes, after, near)
        cost, hit = self._look(chosen)
        total, total_before = float(cost.sum()), float(self._cost[chosen].sum())
        is_better = total < self._settings.max_cost_ratio * total_before
        if keep and is_better:
            self._cost[chosen], self._hit[chosen] = cost, hit
            self._points[chosen] = self._hit_points(chosen)
        else:
            self._set(nodes, before, near)
        return total_before - total if is_better else 0.0

    def _set(self, nodes, values, near) -> None:
        self._distance[tuple(nodes.T)] = values
        launch(
            grid_kernels.scatter,
            len(nodes),
            to_device(nodes, wp.vec3i),
            to_device(values),
            self._surface.distance,
        )
        self._surface.update_gradient(near)

    def _gradient_nodes(self, plane: Plane, nodes):
        """The nodes, and their neighbors."""
        mask = np.zeros(plane.hi - plane.lo + 2, bool)
        mask[tuple((nodes - plane.lo + 1).T)] = True
        return to_device(np.argwhere(binary_dilation(mask)) + plane.lo - 1, wp.vec3i)

    def _change(self, region: FlatRegion, plane: Plane):
        """Nodes (n, 3) that the plane changes, with their distances before and after."""
        if (plane.hi - plane.lo < 2).any():
            return None
        box = tuple(slice(a, b) for a, b in zip(plane.lo, plane.hi, strict=True))
        nodes = np.argwhere(self._distance[box] < SLAB + 1) + plane.lo
        height = nodes.astype(np.float32) @ plane.normal - plane.offset
        before = self._distance[tuple(nodes.T)]
        is_empty = (height > before) & (before < 1.5)
        is_filled = (height > -SLAB - 2) & (height < 1) & (before > -height)
        chosen = np.flatnonzero(is_empty | is_filled)
        nodes, height, before = nodes[chosen], height[chosen], before[chosen]
        if not len(nodes):
            return None
        inside = region.inside(self._rays, nodes.astype(np.float32))
        after = np.maximum(before, np.minimum(inside, height))
        matter = np.minimum(np.minimum(inside, -height), height + np.float32(SLAB))
        after = np.minimum(after, np.maximum(-matter, np.float32(-SLAB)))
        after = np.maximum(after, self._surface.grid.hull[tuple(nodes.T)])
        if np.count_nonzero((after > 0) != (before > 0)) < MIN_FLIPS:
            return None
        is_changed = np.abs(after - before) > MIN_CHANGE
        return nodes[is_changed], before[is_changed], after[is_changed]

    def _changed_pixels(
        self, region: FlatRegion, plane: Plane, all_of_them: bool
    ) -> Int64[np.ndarray, "n"]:
        """Judging pixels that end in what is emptied, or meet what is filled before they end."""
        budget = 1 << 30 if all_of_them else self._settings.rays_per_trial
        points = self._points
        ending = np.flatnonzero(((points > plane.lo - 1) & (points < plane.hi)).all(axis=1))
        ending = every_nth(ending, 5 * budget)
        ending = ending[points[ending] @ plane.normal - plane.offset > -HIT_MARGIN]
        ending = ending[region.inside(self._rays, points[ending]) > -HIT_MARGIN]
        crossing = np.arange(0, len(points), 1 if all_of_them else 4)
        origins = self._origins[crossing] @ plane.normal - plane.offset
        slope = self._directions[crossing] @ plane.normal
        with np.errstate(divide="ignore", invalid="ignore"):
            length = -origins / slope
        ends = np.where(self._hit[crossing] < 0, np.inf, self._hit[crossing])
        is_before = (origins > 0) & (slope < 0) & (length < ends - 1)
        crossing, length = crossing[is_before], length[is_before]
        meets = self._origins[crossing] + length[:, None] * self._directions[crossing]
        is_in_box = ((meets > plane.lo - 1) & (meets < plane.hi)).all(axis=1)
        crossing, meets = crossing[is_in_box], meets[is_in_box]
        crossing = crossing[region.inside(self._rays, meets) > -HIT_MARGIN]
        return every_nth(np.union1d(ending, crossing), budget)


def every_nth(values: Int64[np.ndarray, "n"], most: int) -> Int64[np.ndarray, "m"]:
    """Every so many values, so that at most about `most` are left."""
    return values[:: len(values) // most + 1]
