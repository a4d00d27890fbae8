"""Caves: hollows that a trained field leaves where no picture constrains it.

No ray ends deep inside the part, so there the field drifts, and its hollows break through to the
outside by cracks.  What a ball of some radius cannot enter from the outside is filled if no ray
passes most of it, for where nothing is seen one expects matter.  The pictures, rendered anew where
they show some of it, must not look clearly less like the photographs then.
"""

from collections.abc import Iterator

import numpy as np
import warp as wp
from jaxtyping import Bool, Float32, Int64
from scipy.ndimage import binary_dilation, find_objects, label, minimum, minimum_filter

from industnerf.geometry.warp_launch import warp_device
from industnerf.methods.industnerf_plus import grid_kernels
from industnerf.methods.industnerf_plus.distance_grid import FILL_VALUE, redistance
from industnerf.methods.industnerf_plus.pictures import Pictures
from industnerf.methods.industnerf_plus.shaded_surface import (
    PinholeRays,
    ShadedSurface,
    launch,
    to_device,
)
from industnerf.methods.industnerf_plus.trials import MIN_FLIPS, PIXEL_STEP, Change, Trials
from industnerf.schema.industnerf import CaveSettings

RADII = (1.0, 2.0, 3.5, 6.0)  # cells, of the balls
MIN_NODES = 12
MAX_CAVES = 60  # of a radius
MIN_DEPTH = 1.0  # cells beyond what a ball reaches ...
MAX_FILLET = 0.3  # ... and of its radius: it rounds off an edge, which is no cave
GROWTH = 3  # nodes; a cave is filled up to so far from where it is deep
RAY_STEP = 0.7  # cells
SEEN_DISTANCE = 2  # nodes from a ray that are seen; judging rays are so far apart
MAX_PROJECTED = 20_000  # nodes of a cave
MARGIN = 2.0  # cells before a cave, where rays that it may change end


def fill_caves(
    surface: ShadedSurface, rays: PinholeRays, pictures: Pictures, settings: CaveSettings
) -> int:
    """Change `surface`, whose light is fitted, where the pictures agree; returns how often."""
    if not settings.max_cost_ratio:
        return 0
    trials = Trials(surface, rays, pictures)
    unseen = unseen_air(trials)
    filled = 0
    for radius in RADII:
        for nodes, closed in caves(trials.distance, unseen, radius, settings.min_unseen_fraction):
            filled += _fill(trials, nodes, closed, settings.max_cost_ratio)
    if filled:
        surface.redistance()
    return filled


def unseen_air(trials: Trials) -> Bool[np.ndarray, "a b c"]:
    """Air in the visual hull that no judging ray passes near."""
    hull, is_used = trials.surface.grid.hull, trials.ends > 0
    is_passed = wp.zeros(hull.shape, wp.uint8, device=warp_device())
    launch(
        grid_kernels.mark_passed,
        int(is_used.sum()),
        to_device(trials.origins[is_used], wp.vec3),
        to_device(trials.directions[is_used], wp.vec3),
        to_device(trials.ends[is_used]),
        RAY_STEP,
        to_device(hull),
        is_passed,
    )
    is_seen = binary_dilation(is_passed.numpy() > 0, iterations=SEEN_DISTANCE)
    return (trials.distance > 0) & (hull < 0) & ~is_seen


def caves(
    distance: Float32[np.ndarray, "a b c"],
    unseen: Bool[np.ndarray, "a b c"],
    radius: float,
    min_unseen_fraction: float,
) -> Iterator[tuple[Int64[np.ndarray, "n 3"], Float32[np.ndarray, "n"]]]:
    """Connected air that a ball cannot enter and that is unseen to this share, the largest first.

    Of each the nodes, with some about it, and their distances to the surface the ball rolls on.
    """
    entered = label(distance > radius)[0]
    # beside where its center may be the ball is kept half a cell out, so that it sags into no crack
    to_center = np.where(
        entered == entered[0, 0, 0], radius - distance, np.maximum(radius - distance, 0.5)
    )
    closed = np.float32(radius) - redistance(to_center)
    labels, number = label((distance > 0) & (closed < -MIN_DEPTH))
    if not number:
        return
    counts = np.bincount(labels.ravel())
    unseen_counts = np.bincount(labels[unseen], minlength=number + 1)
    deepest = minimum(closed, labels, np.arange(number + 1))
    is_cave = (
        (counts >= MIN_NODES)
        & (unseen_counts > min_unseen_fraction * counts)
        & (deepest < -MIN_DEPTH - MAX_FILLET * radius)
    )
    boxes = find_objects(labels)
    order = [k for k in np.argsort(-counts[1:], kind="stable") + 1 if is_cave[k]]
    for k in order[:MAX_CAVES]:
        box = tuple(slice(max(0, s.start - GROWTH), s.stop + GROWTH) for s in boxes[k - 1])
        near = binary_dilation(labels[box] == k, iterations=GROWTH) & (distance[box] > closed[box])
        nodes = np.argwhere(near) + [axis.start for axis in box]
        yield nodes, closed[tuple(nodes.T)]


def _fill(
    trials: Trials,
    nodes: Int64[np.ndarray, "n 3"],
    closed: Float32[np.ndarray, "n"],
    max_cost_ratio: float,
) -> bool:
    """Fill them as far as the ball, or else as the visual hull: whichever looks better."""
    at = tuple(nodes.T)
    before, hull = trials.distance[at], trials.surface.grid.hull[at]
    changes = [
        Change.of(nodes, before, np.minimum(before, np.maximum(hull, cap)))
        for cap in (closed, np.float32(FILL_VALUE))
    ]
    changes = [change for change in changes if change is not None]
    if not changes:
        return False
    chosen = pixels_behind(trials, nodes)
    if len(chosen) < MIN_FLIPS:
        trials.apply(changes[0])
        return True
    verdicts = [trials.attempt(change, chosen, max_cost_ratio, keep=False) for change in changes]
    if not any(verdicts):
        return False
    gains = [verdict.gain if verdict else -np.inf for verdict in verdicts]
    best = changes[int(np.argmax(gains))]
    return trials.attempt(best, chosen, max_cost_ratio, keep=True) is not None


def pixels_behind(trials: Trials, nodes: Int64[np.ndarray, "n 3"]) -> Int64[np.ndarray, "m"]:
    """Judging pixels whose rays end at the nodes, or pass them."""
    rays = trials.rays
    nodes = nodes[:: len(nodes) // MAX_PROJECTED + 1]
    nearest = np.full(trials.lattice_shape, np.inf, np.float32)
    for view, center in enumerate(rays.centers):
        pixel, is_in_frame = rays.project(nodes.astype(float), np.full(len(nodes), view))
        row, column = np.divmod(pixel[is_in_frame] % (rays.height * rays.width), rays.width)
        depth = np.linalg.norm(nodes[is_in_frame] - center, axis=1)
        if not len(depth):
            continue
        np.minimum.at(nearest[view], (row // PIXEL_STEP, column // PIXEL_STEP), depth)
        cell_px = 1 / (np.linalg.norm(rays.pixel_to_ray[view][:, 0]) * depth.min())
        size = 2 * int(cell_px / PIXEL_STEP) + 1  # nodes farther apart than pixels leave some out
        nearest[view] = minimum_filter(nearest[view], size)
    start = nearest[trials.lattice_index] - MARGIN
    return np.flatnonzero((trials.ends > start) | ((trials.ends < 0) & np.isfinite(start)))
