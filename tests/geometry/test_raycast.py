"""Embree against the textbook's intersection, one ray and one triangle at a time."""

import ctypes
import pickle
import subprocess
import sys

import numpy as np
import pytest
from jaxtyping import TypeCheckError

from industnerf.geometry.embree_tree import load_embree
from industnerf.geometry.raycast import RaycastingScene, parallel_ray_bundles
from industnerf.geometry.sphere import fibonacci_sphere

TRIANGLE = np.array([[0.0, 0, 0], [10, 0, 0], [0, 10, 0]]), np.array([[0, 1, 2]], np.int32)


def soup(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Random triangles of some 40 mm about a cube of 100 mm."""
    rng = np.random.default_rng(1)
    corners = rng.uniform(0, 100, (count, 1, 3)) + rng.uniform(-30, 30, (count, 3, 3))
    return corners.reshape(-1, 3), np.arange(3 * count, dtype=np.int32).reshape(-1, 3)


def moller_trumbore(triangle: np.ndarray, origin: np.ndarray, direction: np.ndarray) -> float:
    """Distance in float64, or inf -- Moller and Trumbore (1997), section 2."""
    a, along_u, along_v = triangle[0], triangle[1] - triangle[0], triangle[2] - triangle[0]
    weights = np.linalg.solve(np.stack([-direction, along_u, along_v], axis=1), origin - a)
    t, u, v = weights
    return t if t > 0 and u >= 0 and v >= 0 and u + v <= 1 else np.inf


def test_it_finds_what_the_textbook_finds():
    vertices, faces = soup(40)
    origins = 200 * fibonacci_sphere(100) + 50
    aim = np.random.default_rng(2).uniform(0, 100, (100, 3))
    directions = (aim - origins) / np.linalg.norm(aim - origins, axis=1, keepdims=True)
    hits = RaycastingScene(vertices, faces).cast(origins, directions)
    table = np.array(
        [
            [moller_trumbore(triangle, o, d) for triangle in vertices[faces]]
            for o, d in zip(origins, directions, strict=True)
        ]
    )
    assert 20 < np.isfinite(hits.t).sum() < 100
    # float32 two box sizes from a box of 160 mm: 2 * 160 mm * 6e-8 = 2e-5 mm, some roundings of
    # this kind, and up to ten times as much where a ray grazes its triangle
    np.testing.assert_allclose(hits.t, table.min(axis=1), rtol=0, atol=1e-3)
    np.testing.assert_array_equal(
        hits.face, np.where(np.isfinite(table.min(1)), table.argmin(1), -1)
    )


def test_uv_weigh_the_second_and_third_corner():
    hits = RaycastingScene(*TRIANGLE).cast(np.array([[1.0, 2, 5]]), np.array([[0.0, 0, -1]]))
    np.testing.assert_allclose(hits.uv, [[0.1, 0.2]], rtol=0, atol=1e-6)
    assert hits.t[0] == pytest.approx(5, abs=1e-5)


def test_a_miss_has_no_face_and_infinite_t_whatever_the_size():
    vertices, faces = TRIANGLE
    for size in (1e-3, 1.0, 1e6):  # mm; embree's own `far` times 1e6 would overflow
        hits = RaycastingScene(size * vertices, faces).cast(
            np.full((1, 3), -size), np.array([[0, 0, 1.0]])
        )
        assert hits.face[0] == -1
        assert np.isposinf(hits.t[0])


def test_t_counts_in_lengths_of_the_direction():
    hits = RaycastingScene(*TRIANGLE).cast(
        np.array([[1.0, 1, 6]]), np.array([[0, 0, -1.0], [0, 0, -3]])
    )
    np.testing.assert_allclose(hits.t, [6, 2], rtol=1e-6)


def test_a_part_far_from_the_origin_loses_no_digits():
    vertices, faces = TRIANGLE
    far = np.array([1e6, -2e6, 3e6])  # mm, where float32 counts in quarters of a mm
    distance = RaycastingScene(vertices + far, faces).distance(
        far + np.array([[1.0, 1, 5.0625]]), np.array([[0, 0, -1.0]])
    )
    assert distance[0] == pytest.approx(5.0625, abs=1e-5)


def test_no_ray_slips_between_faces_that_share_an_edge():
    """A fan of thin triangles, hit by rays aimed at its inner edges."""
    angle = np.linspace(0, 2 * np.pi, 97)[:-1]
    rim = np.stack([np.cos(angle), np.sin(angle), np.zeros(96)], axis=1)
    vertices = np.vstack([rim, [[0, 0, 0]]])
    faces = np.array([[i, (i + 1) % 96, 96] for i in range(96)], np.int32)
    targets = (np.linspace(0.01, 0.99, 50)[:, None, None] * rim).reshape(-1, 3)
    camera_center = np.array([[0.3, -0.2, 2.0]])
    assert np.isfinite(
        RaycastingScene(vertices, faces).distance(camera_center, targets - camera_center)
    ).all()


def test_no_rays_give_no_hits():
    hits = RaycastingScene(*TRIANGLE).cast(np.zeros((1, 3)), np.zeros((0, 3)))
    assert hits.t.shape == (0,)
    assert hits.uv.shape == (0, 2)


def test_as_many_origins_as_directions_or_one():
    with pytest.raises(TypeCheckError):
        RaycastingScene(*TRIANGLE).cast(np.zeros((2, 3)), np.ones((3, 3)))


def test_embree_is_imported_only_when_a_scene_is_built():
    code = "import sys, industnerf.geometry.raycast; print('embreex' in sys.modules)"
    output = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert output.stdout.strip() == "False"


def test_a_ray_is_blocked_where_it_meets_the_mesh():
    vertices, faces = soup(40)
    origins = 200 * fibonacci_sphere(300) + 50
    aim = np.random.default_rng(2).uniform(0, 100, (300, 3))
    scene, directions = RaycastingScene(vertices, faces), aim - origins
    is_occluded = np.isfinite(scene.distance(origins, directions))
    assert 60 < is_occluded.sum() < 300
    np.testing.assert_array_equal(scene.is_occluded(origins, directions), is_occluded)
    past = scene.is_occluded(origins, -directions)  # what lies behind the start does not count
    np.testing.assert_array_equal(past, np.isfinite(scene.distance(origins, -directions)))


def test_a_ray_is_blocked_within_what_is_asked_alone():
    """The first face decides, at any limit; t is a float32, exact to 6e-8 of itself."""
    vertices, faces = soup(40)
    origins = 200 * fibonacci_sphere(3000) + 50
    aim = np.random.default_rng(2).uniform(0, 100, (3000, 3))
    scene = RaycastingScene(vertices, faces)
    for length in (1.0, 1e-6):  # of the directions, over the way to the point aimed at
        directions = length * (aim - origins)
        first = scene.distance(origins, directions).astype(float)
        for within in (0.5 / length, 1 / length, first * (1 - 2e-7), first * (1 + 2e-7)):
            np.testing.assert_array_equal(
                scene.is_occluded(origins, directions, within),
                np.isfinite(first) & (first < within),
            )


LOW, HIGH = np.array([1.0, 2.0, 3.0]), np.array([4.0, 9.0, 5.0])  # mm
CORNERS = np.array([[x, y, z] for x in (1, 4) for y in (2, 9) for z in (3, 5)], dtype=np.float64)


def test_every_beam_starts_outside_and_covers_the_box():
    reach = np.linalg.norm(HIGH - LOW) / 2
    directions = []
    for origins, direction in parallel_ray_bundles(CORNERS, 20, 8):
        directions.append(direction)
        assert np.linalg.norm(direction) == pytest.approx(1)
        # All start on one plane, two reaches before the middle: no corner is so far from it.
        assert (origins - (LOW + HIGH) / 2) @ direction == pytest.approx(-2 * reach)
        # Every corner's ray of the beam passes within half a cell's diagonal of one in the grid.
        across = CORNERS - (CORNERS - origins[0]) @ direction[:, None] * direction
        gap = np.linalg.norm(origins[None] - across[:, None], axis=-1).min(axis=1)
        assert gap.max() <= reach / 8 * np.sqrt(2) + 1e-12
    assert np.linalg.norm(np.mean(directions, axis=0)) < 0.05  # from all round


def test_neighboring_rays_are_a_cell_apart():
    origins, _ = next(parallel_ray_bundles(CORNERS, 1, 8))
    grid = origins.reshape(8, 8, 3)
    cell = np.linalg.norm(HIGH - LOW) / 8
    for steps in (np.diff(grid, axis=0), np.diff(grid, axis=1)):
        np.testing.assert_allclose(np.linalg.norm(steps, axis=-1), cell, rtol=1e-12)


def test_embree_is_held_to_the_vectors_that_all_processors_have():
    """Property 34 of Embree 4's device: whether packets of 16 rays are native, as with AVX-512."""
    embree, device = load_embree()
    get = embree.rtcGetDeviceProperty
    get.restype, get.argtypes = ctypes.c_ssize_t, (ctypes.c_void_p, ctypes.c_uint)
    assert [get(device, number) for number in (33, 34)] == [1, 0]  # of 8, of 16


@pytest.mark.parametrize("count", [100, 20_000])
def test_a_mesh_may_lie_in_memory_either_way(count):
    vertices, faces = soup(count)
    origins = 200 * fibonacci_sphere(500) + 50
    directions = (50 - origins) / 150
    expected = RaycastingScene(vertices, faces).cast(origins, directions)
    other = RaycastingScene(np.array(vertices, order="F"), np.array(faces, order="F"))
    np.testing.assert_array_equal(other.cast(origins, directions).t, expected.t)


def test_a_scene_is_not_sent_to_another_process():
    with pytest.raises(TypeError, match="lives in one process"):
        pickle.dumps(RaycastingScene(*TRIANGLE))


def test_where_a_ray_meets_its_face_is_exact_to_the_last_bit():
    """In float64, which AMD and Intel divide alike; embree's own t is off in every other ray."""
    vertices, faces = soup(40)
    scene = RaycastingScene(vertices, faces)
    origins = 200 * fibonacci_sphere(3000) + 50
    directions = ((50 - origins) / 150).astype(np.float32)
    hits = scene.cast(origins, directions)
    low, size = vertices.min(axis=0), np.ptp(vertices, axis=0).max()
    corners = ((vertices - low) / size).astype(np.float32).astype(float)[faces]
    starts = ((origins - low) / size).astype(np.float32).astype(float)
    is_hit = hits.face >= 0
    t = [
        moller_trumbore(corners[face], start, direction)
        for face, start, direction in zip(
            hits.face[is_hit], starts[is_hit], directions[is_hit].astype(float), strict=True
        )
    ]
    expected = np.float32(t) * np.float32(size)
    # a float64 that lies in the middle of two float32, to its own rounding, may go either way
    assert (hits.t[is_hit] != expected).mean() < 0.01
    assert is_hit.sum() > 50
