"""The visual hull against solids whose hull is known."""

import numpy as np
import pytest
import trimesh
from scipy.spatial import cKDTree

from industnerf.errors import ReconstructionFailed
from industnerf.geometry.cameras import Cameras, look_at
from industnerf.geometry.sphere import fibonacci_sphere
from industnerf.methods import load_method
from industnerf.methods.base import Input
from industnerf.methods.hull import BOUNDARY_OFFSET_PX, hull, surface
from industnerf.methods.hull.octree import refine
from industnerf.methods.hull.silhouettes import distance_images
from industnerf.methods.hull.surface import SEGMENT_LENGTH, sample_hull_surface
from industnerf.schema import HullSettings
from tests.methods.solids import (
    cameras_around,
    cameras_at,
    hull_of_ball,
    masks_of,
    masks_of_ball,
    pixel_mm,
)

SETTINGS = HullSettings(cell_px=0.5, points=20_000)
REACH = 30.0  # mm, what the cameras frame

# Between two unlike pixels the outline is put half-way, so it is off by half a pixel at most;
# a tenth more for its path between such places, and for the last, linear step in space.
OUTLINE_PX = 0.6


def reconstruct(mask: np.ndarray, cameras: Cameras, settings=SETTINGS, seed=0) -> np.ndarray:
    return hull(mask, cameras, settings, seed, dilation_px=0.0)


def distance_to_ball_hull(points: np.ndarray, radius: float, cameras: Cameras) -> np.ndarray:
    """Signed distance to the exact hull, in px."""
    distance = np.linalg.norm(points, axis=1)
    exact = hull_of_ball(points / distance[:, None], radius, cameras)
    return (distance - exact) / pixel_mm(cameras, REACH)


@pytest.mark.parametrize("radius", [REACH, REACH / 2])
@pytest.mark.parametrize("resolution", [64, 160])
def test_a_ball_gives_its_exact_hull(radius, resolution):
    cameras = cameras_around(40, resolution, REACH)
    points = reconstruct(masks_of_ball(radius, cameras), cameras)
    off_px = distance_to_ball_hull(points, radius, cameras)
    assert np.abs(off_px).max() < OUTLINE_PX
    # The error of a single view has mean 0; of those that meet in a point the one that cuts
    # deepest wins, so the mean is negative, but stays far below the largest error.
    assert -0.25 < off_px.mean() < 0


@pytest.mark.parametrize("cell_px", [0.5, 2.0, 8.0])
def test_the_size_of_the_cells_changes_cost_and_not_place(cell_px):
    cameras = cameras_around(40, 96, REACH)
    settings = HullSettings(cell_px, 5000)
    points = reconstruct(masks_of_ball(20.0, cameras), cameras, settings)
    # over a segment of a quarter cell the surface is taken for flat: 2 px of a radius of 31 px
    # sag by 2^2 / (8 * 31) = 0.02 px
    assert np.abs(distance_to_ball_hull(points, 20.0, cameras)).max() < OUTLINE_PX + 0.02


# --- a box whose faces all lie in the plane of some camera: its hull is the box itself -------

TURN = trimesh.transformations.euler_matrix(0.4, 0.3, 0.7)[:3, :3]  # no face along the lattice
HALF = np.array([8.0, 12.0, 18.0])


def face_aligned_box(resolution: int) -> tuple[np.ndarray, Cameras]:
    directions = []
    for axis in range(3):
        for side in (-1.0, 1.0):
            along = np.array([0.3, 0.5, 0.7])
            along[axis] = 0.0
            along *= np.sqrt((4.1 * REACH) ** 2 - HALF[axis] ** 2) / np.linalg.norm(along)
            along[axis] = side * HALF[axis]
            directions.append(TURN @ along / (4.1 * REACH))
    cameras = cameras_at(np.concatenate([directions, fibonacci_sphere(20)]), resolution, REACH)
    box = trimesh.creation.box(2 * HALF).apply_transform(
        np.block([[TURN, np.zeros((3, 1))], [np.zeros(3), 1]])
    )
    return masks_of(box, cameras), cameras


@pytest.fixture(scope="module")
def box() -> tuple[np.ndarray, float]:
    """Points on the hull in the frame of the box, and the size of a pixel."""
    mask, cameras = face_aligned_box(160)
    return reconstruct(mask, cameras) @ TURN, pixel_mm(cameras, REACH)


def test_points_know_nothing_of_the_lattice():
    """On a tilted surface every place within a cell is as likely as any other."""
    mask, cameras = face_aligned_box(100)
    silhouettes = distance_images(mask, cameras, 0.0)
    nodes = refine(silhouettes, 3.0, SEGMENT_LENGTH)
    points = sample_hull_surface(silhouettes, nodes, 20_000, np.random.default_rng(0))
    position = (points + 1) / (nodes.side / 2) % 1
    for axis in range(3):
        counts, _ = np.histogram(position[:, axis], 10, (0, 1))
        z = (counts - 2000) / np.sqrt(2000 * 0.9)
        assert np.abs(z).max() < 4  # of 30 counts, by chance once in 500 seeds


def test_drawing_ends_where_hardly_a_segment_crosses(monkeypatch):
    """It then returns what there is: here after one draw, for any crossing is too seldom."""
    mask, cameras = face_aligned_box(32)
    silhouettes = distance_images(mask, cameras, 0.0)
    nodes = refine(silhouettes, 0.5, SEGMENT_LENGTH)
    monkeypatch.setattr(surface, "MIN_CROSSING_RATE", 1.0)
    monkeypatch.setattr(surface, "SEGMENTS_PER_POINT", 1)
    points = sample_hull_surface(silhouettes, nodes, 20_000, np.random.default_rng(0))
    assert 100 < len(points) < 20_000


def test_the_hull_of_a_box_is_the_box(box):
    points, px = box
    beyond = np.abs(points) - HALF
    assert beyond.max() < OUTLINE_PX * px
    # Inside: at an edge two outlines round it off, each within its own error.
    assert beyond.max(axis=1).min() > -2 * OUTLINE_PX * px


def test_points_are_uniform_over_faces_whichever_way_they_look(box):
    points, _ = box
    face = (np.abs(points) - HALF).argmax(axis=1)
    side = points[np.arange(len(points)), face] > 0
    across = (face[:, None] + [1, 2]) % 3
    quarter = np.take_along_axis(points, across, axis=1) > 0
    cell = np.ravel_multi_index((face, side, quarter[:, 0], quarter[:, 1]), (3, 2, 2, 2))
    share = np.repeat(HALF.prod() / HALF, 8) / (8 * (HALF.prod() / HALF).sum())
    expected = len(points) * share
    # Standard errors of the 24 counts; |z| < 4 fails by chance once in 650 seeds.  Crossings of
    # lattice lines would be denser by |n|_1, here by up to 1.7: more than 20 standard errors.
    z = (np.bincount(cell, minlength=24) - expected) / np.sqrt(expected * (1 - share))
    assert np.abs(z).max() < 4


def test_points_are_independent_of_one_another(box):
    """The mean distance to the nearest other point is that of a Poisson process.

    On a plane it is 1 / (2 sqrt(density)), with a standard deviation of 0.52 times itself.
    """
    points, _ = box
    top = points[(np.abs(points) - HALF).argmax(axis=1) == 0]
    top = top[(top[:, 0] > 0) & (np.abs(top[:, 1:]) < HALF[1:] - 1).all(axis=1)][:, 1:]
    distances = cKDTree(top).query(top, k=2)[0][:, 1]
    expected = 0.5 / np.sqrt(len(top) / (2 * HALF[1:] - 2).prod())
    # 5 standard errors, half as much again because neighbors share distances; points at the rim
    # lack neighbors outside: 1 in 40 of them is that near to it
    assert distances.mean() == pytest.approx(expected, rel=7.5 * 0.52 / len(top) ** 0.5)


# --- solids that are not convex --------------------------------------------------------------


def test_a_torus_keeps_its_hole_and_loses_nothing():
    cameras = cameras_around(40, 160, REACH)
    torus = trimesh.creation.torus(20.0, 7.0, major_sections=128, minor_sections=64)
    points = reconstruct(masks_of(torus, cameras), cameras)
    ring = np.hypot(points[:, 0], points[:, 1])
    outside = np.hypot(ring - 20.0, points[:, 2]) - 7.0
    # the mesh is inscribed: its chords cut 7 (1 - cos(pi/64)) + 27 (1 - cos(pi/128)) = 0.017 mm
    assert outside.min() > -OUTLINE_PX * pixel_mm(cameras, REACH) - 0.017
    # From 40 eyes neighboring views are some 30 degrees apart: the tangent planes of a tube of
    # 7 mm meet at 7 / cos 15 deg, 0.25 mm outside; ten times that where the hole hides it.
    assert np.median(outside) < 0.25
    assert ring.min() > 10.0


def test_a_pocket_stays_filled_and_no_point_lies_deep_in_it():
    cup = trimesh.creation.annulus(10.0, 15.0, 30.0, sections=64)
    floor = trimesh.creation.cylinder(15.0, 4.0, sections=64).apply_translation([0, 0, -15])
    filled = trimesh.creation.cylinder(15.0, 30.0, sections=64)
    cameras = cameras_around(40, 128, REACH)
    mask = masks_of(trimesh.util.concatenate([cup, floor]), cameras)
    cup, solid = (reconstruct(m, cameras) for m in (mask, masks_of(filled, cameras) | mask))
    np.testing.assert_array_equal(cup, solid)  # their silhouettes are the same, to the pixel
    in_pocket = (np.hypot(cup[:, 0], cup[:, 1]) < 9.0) & (cup[:, 2] > -12.0)
    assert cup[in_pocket, 2].min() > 15.0 - OUTLINE_PX * pixel_mm(cameras, REACH)


# --- what the images cannot say --------------------------------------------------------------


def test_a_view_that_cuts_the_part_off_excludes_nothing_beyond_its_border():
    """One camera looks past the ball: half of it is out of that frame."""
    cameras = cameras_around(30, 96, REACH)
    turned = cameras.c2w.copy()
    turned[3] = look_at(cameras.centers[3:4], 25.0 * turned[3, :3, 0])[0]
    cut = Cameras(cameras.K, turned, cameras.width, cameras.height)
    mask = masks_of_ball(15.0, cut)
    assert mask[3][:, 0].any()
    assert not mask[3].all(axis=0).any()
    points = reconstruct(mask, cut)
    # exact hull of the cut view's neighbors: without it, or with all of it
    others = cameras[np.arange(30) != 3]
    off_px = distance_to_ball_hull(points, 15.0, cameras)
    assert off_px.min() > -OUTLINE_PX
    assert distance_to_ball_hull(points, 15.0, others).max() < OUTLINE_PX


def test_a_blank_view_is_named():
    cameras = cameras_around(5, 32, REACH)
    mask = masks_of_ball(20.0, cameras)
    mask[[1, 3]] = False
    with pytest.raises(
        ReconstructionFailed, match=r"2 of 5 views show no part, .* view 1 of those"
    ):
        reconstruct(mask, cameras)


@pytest.mark.parametrize("full", [True, False])
def test_silhouettes_without_outline_or_common_volume_fail_and_say_so(full):
    cameras = cameras_around(6, 32, REACH)
    mask = np.full((6, 32, 32), full)
    if not full:  # each view sees a dot in another corner
        mask[:3, :3, :3] = mask[3:, -3:, -3:] = True
    with pytest.raises(ReconstructionFailed, match="no surface"):
        reconstruct(mask, cameras)


# --- silhouettes from color -----------------------------------------------------------------


def test_half_a_pixel_off_makes_touched_pixels_unbiased():
    """Masks of all pixels that the ball touches give the hull of the ball."""
    cameras = cameras_around(30, 96, REACH)
    finer = Cameras(cameras.K * [[[4], [4], [1]]], cameras.c2w, 4 * 96, 4 * 96)
    touched = masks_of_ball(20.0, finer).reshape(30, 96, 4, 96, 4).any(axis=(2, 4))
    points = hull(touched, cameras, SETTINGS, 0, dilation_px=BOUNDARY_OFFSET_PX)
    # as with pixel centers; in the diagonal a pixel is touched from 1 / sqrt(2) away, 0.2 more
    assert -0.25 < distance_to_ball_hull(points, 20.0, cameras).mean() < 0.2


def test_the_hulls_declare_no_more_than_they_use():
    assert load_method("hull").inputs == {Input.MASK}
    assert load_method("hull_rgb").inputs == {Input.RGB, Input.BACKGROUND}
