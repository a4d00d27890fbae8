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
from jaxtyping import Float, Float32, Int64

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
from industnerf.methods.industnerf_plus.shaded_surface import PinholeRays, ShadedSurface
from industnerf.methods.industnerf_plus.trials import (
    HIT_MARGIN,
    MAX_RESIDUAL,
    Change,
    Trials,
    every_nth,
    in_box,
)
from industnerf.schema.industnerf import OpeningSettings

SLAB = 3.0  # cells of matter behind a plane
MATCH = 0.012  # of brightness, between a region and a normal
EXPLAINED_SHARE = 0.8  # of a region's pixels that match within 2 MATCH: nothing to do
AMBIENT_MARGIN = 0.02  # darker regions tell no normal
MAX_FACING = -0.03  # of a ray along a normal
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
        self._rays, self._settings, self._rng = rays, settings, rng
        self._lighting = surface.finishes.lighting
        self._trials = Trials(surface, rays, pictures)
        self._normals = candidate_normals(surface)

    def run(self, regions: list[FlatRegion]) -> int:
        """Try the regions; returns how many proposals stay."""
        residuals = self._residuals(regions)
        order = sorted(range(len(regions)), key=lambda i: (-residuals[i], i))
        accepted = 0
        for i in order:
            if self._trials.number >= self._settings.trials:
                break
            accepted += self._try_region(regions[i])
        return accepted

    def _residuals(self, regions: list[FlatRegion]) -> Float[np.ndarray, "k"]:
        """Sum of the residuals of all pixels of each region, by its samples."""
        color, _ = self._trials.render(np.concatenate([region.samples for region in regions]))
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
        color, hit = self._trials.render(region.samples)
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
        shape = np.array(self._trials.distance.shape)
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
        verdict = self._trials.attempt(change, chosen, self._settings.max_cost_ratio, keep)
        return verdict.gain if verdict else 0.0

    def _change(self, region: FlatRegion, plane: Plane) -> Change | None:
        """What the plane changes."""
        if (plane.hi - plane.lo < 2).any():
            return None
        box = tuple(slice(a, b) for a, b in zip(plane.lo, plane.hi, strict=True))
        distance = self._trials.distance
        nodes = np.argwhere(distance[box] < SLAB + 1) + plane.lo
        height = nodes.astype(np.float32) @ plane.normal - plane.offset
        before = distance[tuple(nodes.T)]
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
        after = np.maximum(after, self._trials.surface.grid.hull[tuple(nodes.T)])
        return Change.of(nodes, before, after)

    def _changed_pixels(
        self, region: FlatRegion, plane: Plane, all_of_them: bool
    ) -> Int64[np.ndarray, "n"]:
        """Judging pixels that end in what is emptied, or meet what is filled before they end."""
        budget = 1 << 30 if all_of_them else self._settings.rays_per_trial
        trials = self._trials

        def inside(points):
            before_plane = points @ plane.normal - plane.offset
            return np.minimum(before_plane, region.inside(self._rays, points))

        ending = trials.ending_in(plane.lo, plane.hi, inside, 5 * budget)
        crossing = np.arange(0, len(trials.points), 1 if all_of_them else 4)
        origins = trials.origins[crossing] @ plane.normal - plane.offset
        slope = trials.directions[crossing] @ plane.normal
        with np.errstate(divide="ignore", invalid="ignore"):
            length = -origins / slope
        ends = np.where(trials.ends[crossing] < 0, np.inf, trials.ends[crossing])
        is_before = (origins > 0) & (slope < 0) & (length < ends - 1)
        crossing, length = crossing[is_before], length[is_before]
        meets = trials.origins[crossing] + length[:, None] * trials.directions[crossing]
        met = in_box(meets, plane.lo, plane.hi)
        crossing, meets = crossing[met], meets[met]
        crossing = crossing[region.inside(self._rays, meets) > -HIT_MARGIN]
        return every_nth(np.union1d(ending, crossing), budget)


def candidate_normals(surface: ShadedSurface) -> Float[np.ndarray, "k 3"]:
    """Frequent normals of the surface, and their opposites."""
    nodes = band_nodes(surface.distance.numpy(), SAME_OFFSET)
    found = frequent_normals(surface.normals(nodes.astype(float)))
    has_opposite = (found @ found.T < -cosine(NORMAL_MATCH_DEG)).any(axis=1)
    return np.concatenate([found, -found[~has_opposite]])
