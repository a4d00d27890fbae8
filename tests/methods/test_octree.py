"""The octree holds every place that the surface crosses, in cells of the size asked for."""

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from industnerf.methods.hull.octree import OCTANTS, OctreeNodes, classify_cells, refine
from industnerf.methods.hull.silhouettes import Silhouettes, bilinear, distance_images
from industnerf.methods.hull.surface import SEGMENT_LENGTH, silhouette_distance
from tests.methods.solids import cameras_around, masks_of, masks_of_ball

REACH = 30.0  # mm, what the cameras frame


@pytest.mark.parametrize("cell_px", [0.5, 0.7, 3.0, 8.0])
@pytest.mark.parametrize("resolution", [8, 64, 100])
def test_cells_are_as_small_as_asked_and_not_much_smaller(cell_px, resolution):
    cameras = cameras_around(5, resolution, REACH)
    silhouettes = distance_images(masks_of_ball(20.0, cameras), cameras, 0.0)
    side_mm = refine(silhouettes, cell_px, SEGMENT_LENGTH).side / 2 * silhouettes.radius_mm
    nearest_mm = np.linalg.norm(cameras.centers, axis=1).min() - silhouettes.radius_mm
    spans_px = side_mm * cameras.K[0, 0, 0] / nearest_mm
    widest_px = 2 * silhouettes.radius_mm / side_mm * spans_px  # the region of interest
    # The region is cut into a whole number of first cells, at least 32 and no smaller than 4 px:
    # rounding that number up to an even one makes them smaller by 2 in 32 at most.
    least_px = min(cell_px, widest_px / 32) * (1 - 2 / 32)
    assert least_px <= spans_px <= cell_px * (1 + 1e-6)


@given(st.floats(0, 2 * np.pi), st.integers(0, 2**32 - 1))
def test_a_verdict_holds_all_over_the_ball(angle, seed):
    """Balls near the outline of a half-plane, so large that near and far side differ by a third.

    The outline passes the image's center at `angle`.
    """
    cameras = cameras_around(1, 64, REACH)
    v, u = np.mgrid[:64, :64] - 31.5
    silhouettes = distance_images((np.cos(angle) * u + np.sin(angle) * v > 0)[None], cameras, 0.0)
    rng, radius = np.random.default_rng(seed), np.float32(0.3)
    centers = rng.uniform(-0.6, 0.6, (1000, 3)).astype(np.float32)
    around = rng.standard_normal((200, 3))
    around *= radius / np.linalg.norm(around, axis=1, keepdims=True)
    classification = classify_cells(silhouettes, 0, centers, np.zeros((8, 3), np.float32), radius)
    outside, is_open = (np.unpackbits(bits).reshape(-1, 8)[:, 0] > 0 for bits in classification)
    depths = depth_in_all_views(silhouettes, (centers[:, None] + around).reshape(-1, 3)).reshape(
        1000, -1
    )
    # 0.1 px: by so much a distance may be overstated, see test_silhouettes
    slack = 0.1 * 5 / cameras.K[0, 0, 0]  # at most, at the depth 5
    assert outside.any()
    assert is_open.any()
    assert (~outside & ~is_open).any()
    assert depths[outside].max() < slack
    assert depths[~outside & ~is_open].min() > -slack


def depth_in_all_views(silhouettes: Silhouettes, points: np.ndarray) -> np.ndarray:
    """Depth in the hull asked of all views."""
    depths = []
    for view, image in enumerate(silhouettes.distance):
        u, v, z = silhouettes.projection[view] @ np.column_stack([points, np.ones(len(points))]).T
        u, v = (x.astype(np.float32) for x in (u / z, v / z))
        depths.append(bilinear(image, u, v) * z / silhouettes.max_focal_px[view])
    return np.min(depths, axis=0)


def open_child(nodes: OctreeNodes, points: np.ndarray) -> np.ndarray:
    """Number of the open child that each point lies in, -1 if in none."""
    cell = np.floor((points + 1) / (nodes.side / 2)).astype(int)
    octant = (cell & 1) @ [4, 2, 1]
    np.testing.assert_array_equal(OCTANTS[octant], cell & 1)
    known = {tuple(parent): i for i, parent in enumerate(nodes.parents.tolist())}
    family = np.array([known.get(tuple(parent), -1) for parent in (cell >> 1).tolist()])
    is_open = (nodes.open_children[family] >> (7 - octant) & 1).astype(bool) & (family >= 0)
    return np.where(is_open, 8 * family + octant, -1)


@given(st.integers(0, 2**32 - 1), st.sampled_from([0.5, 1.0, 3.0]))
def test_every_crossing_starts_in_an_open_cell_which_knows_its_sign(seed, cell_px):
    """Two balls and a rod through the hull's region, so that views hide one behind another."""
    cameras = cameras_around(6, 32, REACH)
    rng = np.random.default_rng(seed)
    balls = [
        trimesh.creation.icosphere(2, r).apply_translation(rng.uniform(-12, 12, 3))
        for r in (4.0, 9.0)
    ]
    rod = trimesh.creation.cylinder(2.0, segment=rng.uniform(-15, 15, (2, 3)))
    silhouettes = distance_images(
        masks_of(trimesh.util.concatenate([*balls, rod]), cameras), cameras, 0.0
    )
    nodes = refine(silhouettes, cell_px, SEGMENT_LENGTH)
    start = rng.uniform(-0.6, 0.6, (20_000, 3))
    step = rng.standard_normal(start.shape)
    step *= SEGMENT_LENGTH * nodes.side / 2 / np.linalg.norm(step, axis=1, keepdims=True)
    ends = np.stack([start, start + step]).astype(np.float32)
    inside = np.stack([depth_in_all_views(silhouettes, end) > 0 for end in ends])
    child = open_child(nodes, start)
    crosses = inside[0] != inside[1]
    assert crosses.any()
    # a verdict may err by 0.1 px: see test_silhouettes
    assert (child[crosses] >= 0).mean() > 0.999
    known = np.flatnonzero(child >= 0)
    depth_sign = silhouette_distance(silhouettes, nodes, child[known], ends[:, known]) > 0
    assert (depth_sign == inside[:, known]).mean() > 0.999
