"""What silhouettes can show, on solids whose visual hull is known in closed form."""

import numpy as np
import pytest

from industnerf.artifacts.part import Mesh
from industnerf.geometry.raycast import RaycastingScene
from industnerf.geometry.sampling import sample_surface
from industnerf.geometry.visual_hull import is_on_visual_hull
from tests.solids import (
    GENERIC_ROTATION,
    ball,
    box,
    combine_meshes,
    cup,
    torus,
    transform_mesh,
    tube,
)

COUNT = 2000


def hull_visibility(mesh: Mesh, depth_mm: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points of the surface, their normals, and whether they are on the visual hull."""
    points, face = sample_surface(mesh.vertices, mesh.faces, COUNT, np.random.default_rng(1))
    a, b, c = mesh.triangles[face].swapaxes(0, 1)
    normals = np.cross(b - a, c - a)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    scene = RaycastingScene(mesh.vertices, mesh.faces)
    is_visible = is_on_visual_hull(scene, points, normals, depth_mm, np.random.default_rng(2))
    return points, normals, is_visible


@pytest.mark.parametrize(
    "solid", [ball(10), box(20, 30, 40), transform_mesh(box(1, 2, 30), rotation=GENERIC_ROTATION)]
)
def test_all_of_a_convex_solid_is_on_its_hull(solid):
    assert hull_visibility(solid, 1e-3)[2].all()


def test_of_a_cup_the_inside_is_not():
    """A line through the inside ends in the cup on its lower side; on a level one, on both."""
    points, normals, is_visible = hull_visibility(cup(inner=8, outer=10, floor=2, height=20), 0.05)
    radius = np.hypot(points[:, 0], points[:, 1])
    wall = (radius < 9) & (np.abs(normals[:, 2]) < 0.5)
    floor = (normals[:, 2] > 0.5) & (points[:, 2] < 0)
    assert wall.any()
    assert floor.any()
    np.testing.assert_array_equal(is_visible, ~(wall | floor))


def test_a_bore_is_seen_through_along_its_axis():
    # sqrt(2 * 3 * 0.1) / 30 = 0.026 rad; a line is tried within 1/89 of a quarter turn, 0.018.
    assert hull_visibility(transform_mesh(tube(3, 5, 30), rotation=GENERIC_ROTATION), 0.1)[2].all()


def test_a_channel_is_seen_along_and_a_trough_is_not():
    """A floor between two walls, and the same closed by two further walls."""
    floor = box(30, 10, 2)
    sides = [transform_mesh(box(30, 2, 8), offset=(0, y, 5)) for y in (-4, 4)]
    ends = [transform_mesh(box(2, 6, 8), offset=(x, 0, 5)) for x in (-14, 14)]
    for solid, is_visible in (
        (combine_meshes(floor, *sides), True),
        (combine_meshes(floor, *sides, *ends), False),
    ):
        points, normals, is_visible_too = hull_visibility(solid, 0.1)
        # On the floor, away from the walls and from the edge that the bodies share.
        well = (normals[:, 2] > 0.5) & (np.abs(points[:, 2] - 1) < 1e-9)
        well &= (np.abs(points[:, 0]) < 12.5) & (np.abs(points[:, 1]) < 2.5)
        assert well.sum() > 50
        assert is_visible_too[well].all() if is_visible else not is_visible_too[well].any()


def test_of_a_torus_the_rim_of_the_hole_is_not():
    """Between the top of the tube and the plane that touches the tube on both sides of the hole.

    In the tangent plane at the angle g inwards of the top, sin g < r / R, every line that passes
    the hole meets the far side of the tube; at sin g = r / R the plane cuts Villarceau's circles.
    The hull lies r (1 - cos) of the angle to the nearer end of that band above the surface.
    """
    major, minor, depth = 20.0, 10.0, 0.01
    points, _, is_visible = hull_visibility(torus(major, minor, sections=192), depth)
    inwards = np.arctan2(major - np.hypot(points[:, 0], points[:, 1]), np.abs(points[:, 2]))
    end, shallow = np.arcsin(minor / major), np.arccos(1 - depth / minor)
    facet = 2 * np.pi / 192  # by which a normal may be off
    assert is_visible[(inwards < -facet) | (inwards > end + facet)].all()
    assert not is_visible[(inwards > shallow + facet) & (inwards < end - shallow - facet)].any()


def test_no_line_enters_a_hollow():
    shell = ball(5)
    inside = Mesh.with_one_appearance(shell.vertices, np.ascontiguousarray(shell.faces[:, ::-1]))
    points, _, is_visible = hull_visibility(combine_meshes(ball(10), inside), 0.05)
    np.testing.assert_array_equal(is_visible, np.linalg.norm(points, axis=1) > 7)
