"""The surface as triangles, of pictures by an analytic ray caster: closed, in place, in color."""

from types import SimpleNamespace

import numpy as np
import pytest
import trimesh

from industnerf.artifacts.renderings import Renderings
from industnerf.errors import ReconstructionFailed
from industnerf.geometry.cameras import Cameras, pixel_centers, ray_directions
from industnerf.reconstruct import mesh
from tests.methods.industnerf.synthetic_scenes import (
    CENTER,
    SCENE_RADIUS,
    Solid,
    ball,
    cup,
    orbit_cameras,
)

VIEWS = 24
RADIUS = 18.0
CELL = 2 * SCENE_RADIUS / mesh.GRID_RES  # mm
PIXEL = 2 * SCENE_RADIUS / mesh.MAX_RENDER_SIZE  # mm, about
OPPOSITE_POINTS = CENTER + RADIUS * np.array([[1.0, 0, 0], [-1, 0, 0]])
RED_AND_BLUE = np.array([[200, 0, 0], [0, 0, 200]], np.uint8)


def ray_cast_depths(solid: Solid, cameras: Cameras) -> np.ndarray:
    """z of what every pixel's center shows; 0 is background."""
    images = []
    for K, c2w in zip(cameras.K, cameras.c2w, strict=True):
        directions = ray_directions(pixel_centers(cameras.width, cameras.height), K, c2w)
        t = solid.hit_distance(np.broadcast_to(c2w[:3, 3] - CENTER, directions.shape), directions)
        images.append(np.where(np.isfinite(t), t * (directions @ c2w[:3, 2]), 0))
    return np.reshape(images, (-1, cameras.height, cameras.width)).astype(np.float32)


def fake_result(solid: Solid | None, points: np.ndarray, colors: np.ndarray) -> SimpleNamespace:
    """As `run` has it; pictures of `solid`, or of nothing."""

    def render_views(cameras: Cameras, background: np.ndarray) -> Renderings:
        assert max(cameras.width, cameras.height) == mesh.MAX_RENDER_SIZE
        assert len(background) == len(cameras)
        shape = (len(cameras), cameras.height, cameras.width)
        depth = ray_cast_depths(solid, cameras) if solid else np.zeros(shape, np.float32)
        opacity = np.where(depth > 0, 255, 0).astype(np.uint8)
        return Renderings(np.zeros((*shape, 3), np.uint8), depth, opacity)

    return SimpleNamespace(
        points=points.astype(np.float32),
        colors=colors,
        render_views=render_views,
        background=np.ones((VIEWS, 3)),
        mesh=None,
    )


def test_a_ball_is_a_closed_ball_of_its_size_in_its_place():
    cameras = orbit_cameras(VIEWS, 512)
    extracted = mesh.extract_mesh(
        fake_result(ball(RADIUS), OPPOSITE_POINTS, RED_AND_BLUE), cameras, CENTER, SCENE_RADIUS
    )
    assert extracted.is_watertight
    error = np.linalg.norm(extracted.vertices - CENTER, axis=1) - RADIUS
    # a cell between two centers of a lattice, seen by pixels half a pixel off
    assert np.abs(error).max() < CELL + PIXEL
    assert np.abs(error).mean() < CELL / 2
    volume = 4 / 3 * np.pi * RADIUS**3
    assert extracted.volume == pytest.approx(volume, rel=3 * CELL / 2 / RADIUS)  # and not negative


def test_a_pocket_stays_open():
    """Closed, it would have four fifths more volume; its own is known."""
    cameras = orbit_cameras(VIEWS, 512)
    extracted = mesh.extract_mesh(
        fake_result(cup(), OPPOSITE_POINTS, RED_AND_BLUE), cameras, CENTER, SCENE_RADIUS
    )
    expected_volume = 32 * 32 * 20 - 24 * 24 * 16
    walls = 2 * (32 * 32 + 2 * 32 * 20) + 4 * 24 * 16  # mm^2
    assert extracted.volume == pytest.approx(expected_volume, abs=walls * CELL / 2)


def test_a_vertex_has_the_color_of_the_nearest_point():
    cameras = orbit_cameras(VIEWS, 512)
    extracted = mesh.extract_mesh(
        fake_result(ball(RADIUS), OPPOSITE_POINTS, RED_AND_BLUE), cameras, CENTER, SCENE_RADIUS
    )
    is_right = extracted.vertices[:, 0] > CENTER[0]
    vertex_rgb = np.asarray(extracted.visual.vertex_colors)[:, :3]
    np.testing.assert_array_equal(vertex_rgb, RED_AND_BLUE[np.where(is_right, 0, 1)])


def test_nothing_seen_is_no_mesh():
    with pytest.raises(ReconstructionFailed, match="no mesh"):
        mesh.extract_mesh(
            fake_result(None, OPPOSITE_POINTS, RED_AND_BLUE),
            orbit_cameras(VIEWS, 512),
            CENTER,
            SCENE_RADIUS,
        )


def test_what_only_one_camera_sees_is_no_mesh():
    """All others see through where it is."""
    result = fake_result(ball(RADIUS), OPPOSITE_POINTS, RED_AND_BLUE)
    render_all = result.render_views

    def render_one(cameras: Cameras, background: np.ndarray) -> Renderings:
        renderings = render_all(cameras, background)
        renderings.depth_mm[1:], renderings.opacity[1:] = 0, 0
        renderings.depth_mm[1:, 0, 0], renderings.opacity[1:, 0, 0] = (
            1,
            255,
        )  # else they say nothing
        return renderings

    result.render_views = render_one
    with pytest.raises(ReconstructionFailed, match=r"thinner than a cell, 0\.312"):
        mesh.extract_mesh(result, orbit_cameras(VIEWS, 512), CENTER, SCENE_RADIUS)


@pytest.mark.parametrize("suffix", [".ply", ".stl", ".obj"])
def test_files_hold_what_was_found(tmp_path, suffix):
    box = trimesh.creation.box((1.0, 2.0, 3.0))
    box.visual.vertex_colors = np.tile([10, 20, 30, 255], (8, 1)).astype(np.uint8)
    path = tmp_path / ".draft"  # a draft's name says nothing of its form
    mesh.export_mesh(path, box, suffix, "mm")
    with path.open("rb") as file:
        read = trimesh.load(file, file_type=suffix[1:])
    read.merge_vertices()
    assert read.is_watertight
    assert read.volume == pytest.approx(6, rel=1e-6)
    if suffix != ".stl":
        np.testing.assert_array_equal(read.visual.vertex_colors[:, :3], [[10, 20, 30]] * 8)


def test_a_surface_of_the_method_is_taken_as_it_is():
    true = trimesh.creation.icosphere(2, RADIUS)
    result = fake_result(None, OPPOSITE_POINTS, RED_AND_BLUE)
    result.mesh = lambda: (true.vertices + CENTER, true.faces.astype(np.int32))
    extracted = mesh.extract_mesh(result, orbit_cameras(VIEWS, 512), CENTER, SCENE_RADIUS)
    np.testing.assert_allclose(extracted.vertices, true.vertices + CENTER)
    is_red = extracted.visual.vertex_colors[:, 0] > 0
    assert (is_red == (true.vertices[:, 0] > 0))[np.abs(true.vertices[:, 0]) > 1].all()


def test_a_method_whose_surface_is_empty_has_no_mesh():
    result = fake_result(None, OPPOSITE_POINTS, RED_AND_BLUE)
    result.mesh = lambda: (np.zeros((0, 3)), np.zeros((0, 3), np.int32))
    with pytest.raises(ReconstructionFailed, match="no surface"):
        mesh.extract_mesh(result, orbit_cameras(VIEWS, 512), CENTER, SCENE_RADIUS)
