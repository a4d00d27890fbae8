"""The surface as triangles, of pictures by an analytic ray caster: closed, in place, in colour."""

from types import SimpleNamespace

import numpy as np
import pytest
import trimesh

from industnerf.artifacts.renderings import Renderings
from industnerf.errors import ReconstructionFailed
from industnerf.geometry.cameras import Cameras, pixel_centres, ray_directions
from industnerf.reconstruct import mesh
from tests.methods.industnerf.scenes import CENTRE, REACH, Solid, around, ball, cup

VIEWS = 24
RADIUS = 18.0
CELL = 2 * REACH / mesh.GRID_RES  # mm
PIXEL = 2 * REACH / mesh.LONGEST  # mm, about
TWO_SIDES = CENTRE + RADIUS * np.array([[1.0, 0, 0], [-1, 0, 0]])
RED_BLUE = np.array([[200, 0, 0], [0, 0, 200]], np.uint8)


def depths(solid: Solid, cameras: Cameras) -> np.ndarray:
    """z of what every pixel's centre shows; 0 is background."""
    images = []
    for K, c2w in zip(cameras.K, cameras.c2w, strict=True):
        directions = ray_directions(pixel_centres(cameras.width, cameras.height), K, c2w)
        t = solid.meets(np.broadcast_to(c2w[:3, 3] - CENTRE, directions.shape), directions)
        images.append(np.where(np.isfinite(t), t * (directions @ c2w[:3, 2]), 0))
    return np.reshape(images, (-1, cameras.height, cameras.width)).astype(np.float32)


def outcome(solid: Solid | None, points: np.ndarray, colours: np.ndarray) -> SimpleNamespace:
    """As `run` has it; pictures of `solid`, or of nothing."""

    def pictures(cameras: Cameras, background: np.ndarray) -> Renderings:
        assert max(cameras.width, cameras.height) == mesh.LONGEST
        assert len(background) == len(cameras)
        shape = (len(cameras), cameras.height, cameras.width)
        depth = depths(solid, cameras) if solid else np.zeros(shape, np.float32)
        opaque = np.where(depth > 0, 255, 0).astype(np.uint8)
        return Renderings(np.zeros((*shape, 3), np.uint8), depth, opaque)

    return SimpleNamespace(
        points=points.astype(np.float32),
        colours=colours,
        pictures=pictures,
        background=np.ones((VIEWS, 3)),
    )


def test_a_ball_is_a_closed_ball_of_its_size_in_its_place():
    cameras = around(VIEWS, 512)
    found = mesh.surface(outcome(ball(RADIUS), TWO_SIDES, RED_BLUE), cameras, CENTRE, REACH)
    assert found.is_watertight
    off = np.linalg.norm(found.vertices - CENTRE, axis=1) - RADIUS
    # a cell between two centres of a lattice, seen by pixels half a pixel off
    assert np.abs(off).max() < CELL + PIXEL
    assert np.abs(off).mean() < CELL / 2
    volume = 4 / 3 * np.pi * RADIUS**3
    assert found.volume == pytest.approx(volume, rel=3 * CELL / 2 / RADIUS)  # and not negative


def test_a_pocket_stays_open():
    """Closed, it would have four fifths more volume; its own is known."""
    cameras = around(VIEWS, 512)
    found = mesh.surface(outcome(cup(), TWO_SIDES, RED_BLUE), cameras, CENTRE, REACH)
    own = 32 * 32 * 20 - 24 * 24 * 16
    walls = 2 * (32 * 32 + 2 * 32 * 20) + 4 * 24 * 16  # mm^2
    assert found.volume == pytest.approx(own, abs=walls * CELL / 2)


def test_a_vertex_has_the_colour_of_the_nearest_point():
    cameras = around(VIEWS, 512)
    found = mesh.surface(outcome(ball(RADIUS), TWO_SIDES, RED_BLUE), cameras, CENTRE, REACH)
    right = found.vertices[:, 0] > CENTRE[0]
    painted = np.asarray(found.visual.vertex_colors)[:, :3]
    np.testing.assert_array_equal(painted, RED_BLUE[np.where(right, 0, 1)])


def test_nothing_seen_is_no_mesh():
    with pytest.raises(ReconstructionFailed, match="no mesh"):
        mesh.surface(outcome(None, TWO_SIDES, RED_BLUE), around(VIEWS, 512), CENTRE, REACH)


def test_what_only_one_camera_sees_is_no_mesh():
    """All others see through where it is."""
    seen = outcome(ball(RADIUS), TWO_SIDES, RED_BLUE)
    whole = seen.pictures

    def of_one(cameras: Cameras, background: np.ndarray) -> Renderings:
        pictures = whole(cameras, background)
        pictures.depth_mm[1:], pictures.opacity[1:] = 0, 0
        pictures.depth_mm[1:, 0, 0], pictures.opacity[1:, 0, 0] = 1, 255  # else they say nothing
        return pictures

    seen.pictures = of_one
    with pytest.raises(ReconstructionFailed, match=r"thinner than a cell, 0\.312"):
        mesh.surface(seen, around(VIEWS, 512), CENTRE, REACH)


@pytest.mark.parametrize("form", [".ply", ".stl", ".obj"])
def test_files_hold_what_was_found(tmp_path, form):
    box = trimesh.creation.box((1.0, 2.0, 3.0))
    box.visual.vertex_colors = np.tile([10, 20, 30, 255], (8, 1)).astype(np.uint8)
    path = tmp_path / ".draft"  # a draft's name says nothing of its form
    mesh.write(path, box, form)
    with path.open("rb") as file:
        read = trimesh.load(file, file_type=form[1:])
    read.merge_vertices()
    assert read.is_watertight
    assert read.volume == pytest.approx(6, rel=1e-6)
    if form != ".stl":
        np.testing.assert_array_equal(read.visual.vertex_colors[:, :3], [[10, 20, 30]] * 8)
