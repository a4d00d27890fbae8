"""Soft shadows: of discs and posts whose shadow is known in closed form."""

import numpy as np
import pytest
import trimesh

from industnerf.artifacts.part import Mesh
from industnerf.capture.ray_hits import Surface
from industnerf.capture.shadows import NUM_PROBES, Shadows, disc_directions

UP = np.array([0.0, 0, 1], np.float32)
FLOOR = np.array([[-50.0, -50, 0], [50, -50, 0], [50, 50, 0], [-50, 50, 0]])
GAP, RADIUS = 20.0, 10.0  # mm: a disc above the floor


def disc_over_floor() -> Mesh:
    disc = trimesh.creation.cylinder(RADIUS, 0.01, sections=256)
    vertices = np.vstack([FLOOR, np.array(disc.vertices) + GAP * UP])
    faces = np.vstack([[[0, 1, 2], [0, 2, 3]], np.array(disc.faces) + 4])
    return Mesh.with_one_appearance(vertices, faces.astype(np.int32))


def visibility_at(
    mesh: Mesh, at: np.ndarray, light_half_angle_deg: float, samples: int, light_dir=UP
):
    """What points of the floor see of a lamp, looked at along a line that misses the disc."""
    surface = Surface(mesh, 30.0)
    shadows = Shadows(surface, light_half_angle_deg, samples)
    camera_center = np.array([0.0, -500, 10])
    hits = surface.intersect(camera_center, (at - camera_center).astype(np.float32))
    assert len(hits.ray) == len(at)
    np.testing.assert_allclose(hits.t, 1, rtol=0, atol=1e-4)
    return shadows.light_visibility(shadows.ray_origins(hits, hits.normal), hits.normal, light_dir)


def along_x(x: np.ndarray) -> np.ndarray:
    return np.stack([x, np.zeros_like(x), np.zeros_like(x)], axis=1)


def test_the_shadow_of_a_disc_before_a_point_is_a_disc():
    """As large as the disc, straight below it; 0.05 mm are the facets' and the start's height."""
    x = np.array([-45.0, -12, -10.05, -9.95, -5, 0, 5, 9.95, 10.05, 12, 45])
    visibility = visibility_at(disc_over_floor(), along_x(x), 0.0, 1)
    np.testing.assert_array_equal(visibility.visible_share, np.abs(x) > RADIUS)
    np.testing.assert_allclose(visibility.mean_cosine, np.abs(x) > RADIUS, rtol=0, atol=1e-6)


def test_a_slanting_lamp_shifts_the_shadow():
    """By the gap times the tangent, here one."""
    x = np.array([-45.0, -30.05, -29.9, -20, -10.1, -9.95, 0, 45])
    visibility = visibility_at(
        disc_over_floor(), along_x(x), 0.0, 4, np.array([0.6, 0, 0.6], np.float32) / 0.6
    )
    np.testing.assert_array_equal(visibility.visible_share, np.abs(x + GAP) > RADIUS)


def overlap(distance: np.ndarray, a: float, b: float) -> np.ndarray:
    """Area that two discs of radii `a` and `b` share, `distance` apart (the lens formula)."""
    d = np.clip(distance, abs(a - b) + 1e-9, a + b - 1e-9)
    one = a * a * np.arccos((d * d + a * a - b * b) / (2 * d * a))
    two = b * b * np.arccos((d * d + b * b - a * a) / (2 * d * b))
    root = (-d + a + b) * (d + a - b) * (d - a + b) * (d + a + b)
    return one + two - 0.5 * np.sqrt(root)


def test_a_penumbra_is_the_part_of_the_lamp_that_the_disc_leaves():
    """Seen from the floor, lamp and disc are discs in the plane of the disc.

    1024 points of Hammersley's set count an area in the lamp to about their perimeter's share,
    some 4 / sqrt(1024); the mean over the penumbra is better than that.
    """
    x = np.linspace(0.5, 30, 40)
    light_half_angle_deg = 15.0
    light_radius = GAP * np.tan(np.radians(light_half_angle_deg))
    visibility = visibility_at(disc_over_floor(), along_x(x), light_half_angle_deg, 1024)
    truth = 1 - overlap(x, RADIUS, light_radius) / (np.pi * light_radius**2)
    np.testing.assert_allclose(visibility.visible_share, truth, rtol=0, atol=0.03)
    assert np.abs(visibility.visible_share - truth).mean() < 0.01
    assert ((visibility.visible_share > 0.05) & (visibility.visible_share < 0.95)).sum() > 8


@pytest.mark.parametrize("samples", [4, 16, 64])
def test_fewer_samples_give_coarser_shares_of_the_same_penumbra(samples):
    x = np.linspace(0.5, 30, 40)
    fine = visibility_at(disc_over_floor(), along_x(x), 15.0, 1024).visible_share
    coarse = visibility_at(disc_over_floor(), along_x(x), 15.0, samples).visible_share
    # cells along the border of half a lamp, each in or out as a whole
    assert np.abs(coarse - fine).max() <= 1.1 / np.sqrt(samples)
    assert np.abs(coarse - fine).mean() <= 0.4 / np.sqrt(samples)


def test_the_points_of_a_lamp_are_even_over_its_disc():
    light_dir = np.array([0.3, -0.5, 0.8], np.float32)
    light_dir /= np.linalg.norm(light_dir)
    points = disc_directions(light_dir, 0.2, 256).astype(float)
    np.testing.assert_allclose(np.linalg.norm(points, axis=1), 1, rtol=0, atol=1e-6)
    axis = light_dir.astype(float)
    flat = points / (points @ axis)[:, None] - axis  # in the plane at the distance 1
    out = np.sort(np.linalg.norm(flat, axis=1))
    np.testing.assert_allclose((out / 0.2) ** 2, (np.arange(256) + 0.5) / 256, rtol=0, atol=1e-5)
    assert np.linalg.norm(flat.mean(axis=0)) < 0.2 / 50


def test_the_points_looked_at_first_stand_on_four_sides_of_the_rim():
    points = disc_directions(UP, 0.2, 16)[-NUM_PROBES:].astype(float)
    turns = np.sort(np.arctan2(points[:, 1], points[:, 0])) / (2 * np.pi)
    np.testing.assert_allclose(np.diff(turns), 0.25, rtol=0, atol=1e-6)
    assert (np.linalg.norm(points[:, :2], axis=1) > 0.8 * 0.2 * 0.97).all()


def test_a_lamp_on_the_horizon_is_half_seen():
    """Over an open plain; its mean height is 4 / (3 pi) of its radius, seen or not half that."""
    visibility = visibility_at(
        Mesh.with_one_appearance(FLOOR, np.array([[0, 1, 2], [0, 2, 3]], np.int32)),
        along_x(np.array([1.0])),
        10.0,
        1024,
        np.array([0, 1.0, 0], np.float32),
    )
    assert visibility.visible_share[0] == pytest.approx(0.5, abs=0.02)
    mean = np.tan(np.radians(10)) * 4 / (3 * np.pi) / 2
    assert visibility.mean_cosine[0] == pytest.approx(mean, rel=0.05)


def test_a_round_part_of_facets_casts_no_shadow_on_itself_where_it_faces_the_lamp():
    """On a ball of 320 facets, 10 degrees each, the terminator is where the normals say."""
    ball = trimesh.creation.icosphere(2, 10.0)
    mesh = Mesh.with_one_appearance(np.array(ball.vertices, float), np.array(ball.faces, np.int32))
    surface = Surface(mesh, 40.0)
    shadows = Shadows(surface, 0.0, 1)
    rng, camera_center = np.random.default_rng(0), np.array([60.0, 0, 0])
    aims = np.stack([np.zeros(2000), *rng.uniform(-7, 7, (2, 2000))], axis=1)
    hits = surface.intersect(camera_center, (aims - camera_center).astype(np.float32))
    normal = hits.normal / np.linalg.norm(hits.normal, axis=0)
    visibility = shadows.light_visibility(shadows.ray_origins(hits, normal), normal, UP)
    cosine = normal[2]
    assert (visibility.visible_share[cosine > 0.05] == 1).all()
    assert (visibility.visible_share[cosine < 0] == 0).all()
