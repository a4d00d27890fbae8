"""What is seen of solids whose visibility is known in closed form."""

import numpy as np
import pytest
import trimesh

from industnerf.geometry.cameras import Cameras, look_at, pinhole
from industnerf.geometry.raycast import RaycastingScene
from industnerf.geometry.sphere import fibonacci_sphere
from industnerf.geometry.visibility import NUM_SAMPLES, area_samples, visible_from, visible_in


def scene_of(mesh: trimesh.Trimesh) -> RaycastingScene:
    return RaycastingScene(np.array(mesh.vertices, float), np.array(mesh.faces, np.int32))


def box_faces() -> np.ndarray:
    """Points inside the six faces of the cube from -10 to 10 mm."""
    side = np.random.default_rng(0).uniform(-9.9, 9.9, (600, 3))
    side[np.arange(600), np.arange(600) % 3] = np.where(np.arange(600) % 2, 10, -10)
    return side


def test_an_eye_sees_the_sides_of_a_convex_solid_that_face_it():
    points, scene = box_faces(), scene_of(trimesh.creation.box((20, 20, 20)))
    for camera_center in 60 * fibonacci_sphere(12):
        axis = np.abs(points).argmax(axis=1)
        outward = np.sign(points[np.arange(600), axis])
        faces_it = outward * camera_center[axis] > 10
        # rounding puts a point within 1e-4 mm of its face; no other face is nearer than 0.1 mm
        np.testing.assert_array_equal(
            visible_from(scene, points, camera_center[None], 1e-3), faces_it
        )


def test_more_eyes_see_what_any_of_them_sees():
    points, scene = box_faces(), scene_of(trimesh.creation.box((20, 20, 20)))
    camera_centers = 60 * fibonacci_sphere(5)
    alone = [
        visible_from(scene, points, camera_center[None], 1e-3) for camera_center in camera_centers
    ]
    np.testing.assert_array_equal(
        visible_from(scene, points, camera_centers, 1e-3), np.any(alone, axis=0)
    )


def test_a_horizon_hides_the_far_side_of_a_ball():
    """From distance d one sees the points of a ball of radius R with cosine above R / d."""
    mesh = trimesh.creation.icosphere(subdivisions=5, radius=10)
    camera_center = np.array([[0.0, 0, 30]])
    points = 10 * fibonacci_sphere(2000)
    is_visible = visible_from(scene_of(mesh), points, camera_center, 0.01)
    cosine = points[:, 2] / 10
    # The points lie up to 0.006 mm outside the facets, the tolerance lets in 0.01 mm more: on the
    # horizon 0.02 mm of depth are sqrt(2 * 0.02 / 10) = 0.06 rad.
    assert is_visible[cosine > 1 / 3 + 0.01].all()
    assert not is_visible[cosine < 1 / 3 - 0.07].any()


def test_the_tolerance_is_a_depth():
    scene = scene_of(trimesh.creation.box((20, 20, 20)))
    beneath = np.array([[1.0, 2, 9.5], [1, 2, 8.5]])
    camera_center = np.array([[1.0, 2, 100]])
    np.testing.assert_array_equal(visible_from(scene, beneath, camera_center, 1.0), [True, False])


def test_a_point_before_the_surface_is_seen():
    scene = scene_of(trimesh.creation.box((20, 20, 20)))
    assert visible_from(scene, np.array([[0.0, 0, 30]]), np.array([[0.0, 0, 100]]), 0.0).all()


def test_a_camera_sees_what_is_in_its_frame_alone():
    """The cube from 60 mm above its top: the frame holds a square of 50 tan(5 degrees) each way."""
    points, scene = box_faces(), scene_of(trimesh.creation.box((20, 20, 20)))
    camera_center = np.array([[0.0, 0, 60]])
    on_top = points[:, 2] == 10
    for fov_deg in (10.0, 60.0):
        cameras = Cameras(pinhole(fov_deg, 64)[None], look_at(camera_center, np.zeros(3)), 64, 64)
        radius = 50 * np.tan(np.radians(fov_deg / 2))
        in_frame = on_top & (np.abs(points[:, :2]).max(axis=1) <= radius)
        np.testing.assert_array_equal(visible_in(scene, points, cameras, 1e-3), in_frame)
    facing_away = Cameras(
        pinhole(60.0, 64)[None], look_at(camera_center, 2 * camera_center[0]), 64, 64
    )
    assert not visible_in(scene, points, facing_away, 1e-3).any()


def test_cameras_together_see_what_any_of_them_sees():
    points, scene = box_faces(), scene_of(trimesh.creation.box((20, 20, 20)))
    camera_centers = 100 * fibonacci_sphere(6)
    K = np.tile(pinhole(12.0, 64), (6, 1, 1))
    cameras = Cameras(K, look_at(camera_centers, np.array([5.0, 0, 0])), 64, 64)
    alone = [visible_in(scene, points, cameras[np.array([i])], 1e-3) for i in range(6)]
    np.testing.assert_array_equal(visible_in(scene, points, cameras, 1e-3), np.any(alone, axis=0))
    assert 0.1 < np.any(alone, axis=0).mean() < 0.99


def test_area_samples_are_the_same_for_all_who_ask():
    """And lie on the surface: their tolerance is 1e-4 of the diagonal."""
    box = trimesh.creation.box((20, 30, 40))
    arrays = np.array(box.vertices, float), np.array(box.faces, np.int32)
    (points, tolerance_mm), (again, _) = area_samples(*arrays), area_samples(*arrays)
    np.testing.assert_array_equal(points, again)
    assert len(points) == NUM_SAMPLES
    off = (np.abs(points) - [10, 15, 20]).max(axis=1)
    np.testing.assert_allclose(off, 0, rtol=0, atol=1e-12)
    assert tolerance_mm == pytest.approx(1e-4 * np.sqrt(2900), rel=1e-12)
