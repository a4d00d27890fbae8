"""Fused depth against solids in closed form."""

import numpy as np
import pytest
import trimesh

from industnerf.errors import ReconstructionFailed
from industnerf.geometry import tsdf
from industnerf.geometry.cameras import Cameras, common_view_ball, unit_ball_projections
from industnerf.methods import load_method
from industnerf.methods.base import Input, MethodInputs, Role
from industnerf.methods.tsdf import reconstruct
from industnerf.schema import TsdfSettings
from tests.methods.solids import cameras_around, cup, render_painted

REACH = 30.0  # mm, what the cameras frame
SETTINGS = TsdfSettings(grid_res=64, truncation=2.0, points=20_000)
CAMERAS = cameras_around(40, 192, REACH)
CELL = 2 * common_view_ball(CAMERAS)[1] / SETTINGS.grid_res  # 1 mm


def points_of(depth_mm: np.ndarray, cameras: Cameras = CAMERAS) -> np.ndarray:
    inputs = MethodInputs("tsdf", cameras, cameras, {Input.DEPTH: depth_mm})
    return reconstruct(inputs, SETTINGS, None, 0).points_mm


def depth_of(mesh: trimesh.Trimesh, cameras: Cameras = CAMERAS) -> np.ndarray:
    return render_painted(mesh, cameras, np.zeros_like)[0]


def test_a_ball_to_a_fraction_of_a_cell():
    error = np.linalg.norm(points_of(depth_of(trimesh.creation.icosphere(5, 20.0))), axis=1) - 20.0
    # A pixel's depth stands for points up to half a pixel aside: 0.17 mm times the slope, with
    # either sign and averaged over some 15 views.  The chord of a cell sags 1 / (8 * 20) mm.
    assert np.abs(error).max() < 0.25 * CELL
    assert abs(error.mean()) < 0.03 * CELL


def test_a_box_keeps_its_faces_and_its_edges():
    half = np.array([16.0, 9.0, 12.0])
    points = points_of(depth_of(trimesh.creation.box(2 * half)))
    beyond = (np.abs(points) - half).max(axis=1)
    # faces as a ball's; marching cubes cuts an edge off by up to a cell's diagonal
    assert np.abs(beyond).max() < np.sqrt(3) * CELL
    assert np.median(np.abs(beyond)) < 0.1 * CELL
    np.testing.assert_allclose(np.abs(points).max(axis=0), half, atol=0.5 * CELL)


def test_the_floor_of_a_cup_is_found_where_no_silhouette_shows_it():
    points = points_of(depth_of(cup(18.0, 13.0, 24.0, 6.0)))
    above = (np.hypot(points[:, 0], points[:, 1]) < 11.0) & (points[:, 2] > -11.0)
    assert above.sum() > 500
    assert np.abs(points[above, 2] - (6.0 - 12.0)).max() < 0.5 * CELL


def test_a_wall_of_two_cells_keeps_its_thickness():
    """What an image sees in front says nothing of the wall's far side."""
    points = points_of(depth_of(trimesh.creation.box([40.0, 30.0, 2 * CELL])))
    flat = (np.abs(points[:, 0]) < 18.0) & (np.abs(points[:, 1]) < 13.0)
    assert np.abs(np.abs(points[flat, 2]) - CELL).max() < 0.25 * CELL


def test_what_no_image_sees_stays_solid():
    """From one side alone, all that is behind the ball and in its shadow is left."""
    above = CAMERAS[np.flatnonzero(CAMERAS.centers[:, 2] > 0.97 * 4.1 * REACH)[:1]]
    depth = depth_of(trimesh.creation.icosphere(4, 15.0), above)
    values = tsdf.fuse(
        depth / np.float32(REACH), unit_ball_projections(above, np.zeros(3), REACH), 32, 0.125
    )
    assert values[16, 16, 2] == np.float32(0.125)  # in the shadow
    assert values[16, 16, 16] == np.float32(0.125)  # inside
    assert values[16, 16, 29] == values[2, 16, 16] == np.float32(-0.125)  # seen empty


def test_images_of_nothing_say_so():
    with pytest.raises(ReconstructionFailed, match=r"no surface: 0 pixels of 40 views"):
        points_of(np.zeros((40, 192, 192), np.float32))


def test_it_is_a_bound_and_is_given_depth_alone():
    method = load_method("tsdf")
    assert (method.role, method.inputs) == (Role.BOUND, {Input.DEPTH})
