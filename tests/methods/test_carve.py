"""Space carving against solids in closed form, painted so that a pocket shows."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from scipy.ndimage import maximum_filter, minimum_filter

from industnerf.errors import ReconstructionFailed
from industnerf.geometry.cameras import common_view_ball
from industnerf.geometry.silhouettes import silhouette_distances
from industnerf.methods import load_method
from industnerf.methods.base import Input, MethodInputs, Reconstruction
from industnerf.methods.carve import depth_in_carved, reconstruct
from industnerf.photohull.space_carving import color_ranges, surface_voxels
from industnerf.photohull.voxel_grid import depth_in_hull, unit_frame_cameras
from industnerf.schema import CarveSettings
from tests.methods.solids import (
    cameras_around,
    cup,
    hull_of_ball,
    masks_of_ball,
    pixel_mm,
    render_painted,
)

REACH = 30.0  # mm, what the cameras frame
CAMERAS = cameras_around(40, 192, REACH)
CELL = 2 * common_view_ball(CAMERAS)[1] / 64  # 1 mm
SETTINGS = CarveSettings(
    grid_res=64,
    background_tolerance=0.02,
    color_threshold=0.05,
    voxel_footprint=1.0,
    min_view_cosine=0.7,
    outlier_fraction=0.1,
    min_views=3,
    max_sweeps=32,
    min_silhouette_coverage=0.95,
    points=20_000,
)
STRICT = replace(
    SETTINGS,
    color_threshold=0.0,
    outlier_fraction=0.0,
    voxel_footprint=0.3,
    min_view_cosine=-0.9,
    max_sweeps=200,
)
CUP = cup(18.0, 13.0, 24.0, 6.0)  # its floor is at -6, its rim at 12


def gray(points: np.ndarray) -> np.ndarray:
    return np.full(points.shape, 120)


def waves(points: np.ndarray) -> np.ndarray:
    """Another color every few mm, and none like white: the pocket's floor is no plain face."""
    return 110 + 80 * np.sin(points * [0.9, 0.7, 0.8])


def carve_reconstruction(mesh, paint, settings=SETTINGS) -> Reconstruction:
    rgb = render_painted(mesh, CAMERAS, paint)[1]
    loaded = {Input.RGB: rgb, Input.BACKGROUND: np.ones((len(CAMERAS), 3))}
    return reconstruct(MethodInputs("carve", CAMERAS, CAMERAS, loaded), settings, None, 0)


def points_of(mesh, paint, settings=SETTINGS) -> np.ndarray:
    return carve_reconstruction(mesh, paint, settings).points_mm


def height_in_pocket(points: np.ndarray) -> np.ndarray:
    """z of the points above the floor's middle, the outer bottom left out."""
    return points[(np.hypot(points[:, 0], points[:, 1]) < 9.0) & (points[:, 2] > -11.0), 2]


def test_the_pocket_of_a_painted_cup_is_opened_down_to_its_floor():
    closed = height_in_pocket(points_of(CUP, waves, replace(SETTINGS, max_sweeps=0)))
    assert closed.min() > 12.0 - CELL  # the hull is a lid
    opened = height_in_pocket(points_of(CUP, waves))
    # A pixel may mean a cell's width about it: the floor is left a cell high, and stairs on it
    # are smoothed.  What stands higher, on a few cells that no three views see straight, is rare.
    assert np.median(opened) == pytest.approx(-6.0, abs=1.5 * CELL)
    assert np.quantile(opened, 0.95) < -6.0 + 4 * CELL
    assert opened.min() > -6.0 - 1.5 * CELL


def test_where_the_photographs_say_nothing_the_hull_stays_as_it_is():
    kept = points_of(CUP, gray)
    np.testing.assert_array_equal(kept, points_of(CUP, gray, replace(SETTINGS, max_sweeps=0)))


HALF = np.array([15.0, 10.0, 13.0])
TURN = trimesh.transformations.euler_matrix(0.4, 0.3, 0.7)


@pytest.mark.parametrize(
    ("solid", "outside"),
    [
        (trimesh.creation.icosphere(5, 20.0), lambda p: np.linalg.norm(p, axis=1) - 20.0),
        (trimesh.creation.box(2 * HALF), lambda p: (np.abs(p) - HALF).max(axis=1)),
    ],
)
def test_a_painted_solid_without_pockets_is_not_eaten(solid, outside):
    """Its own surface is consistent, at edges and outlines too."""
    points = points_of(solid.copy().apply_transform(TURN), waves)
    distance = outside(points @ TURN[:3, :3])
    # at most a cell in a hundred loses its neighbors' support and goes; the rest is the hull,
    # which near an edge stands out by what 40 views leave of it
    assert np.quantile(distance, 0.01) > -CELL
    assert np.median(np.abs(distance)) < 0.5 * CELL


def test_the_first_solid_is_the_hull():
    cameras = cameras_around(30, 160, REACH)
    rig = unit_frame_cameras(cameras)
    depth = depth_in_hull(silhouette_distances(masks_of_ball(20.0, cameras)), rig, 64)
    centers = (np.indices(depth.shape).reshape(3, -1).T + 0.5) / 32 - 1
    distances = np.linalg.norm(centers, axis=1)
    exact = hull_of_ball(centers / distances[:, None], 20.0, cameras) / rig.radius_mm
    near = np.abs(distances - exact) < 1 / 32
    difference = (depth.ravel() - (exact - distances) * 32)[near]
    # outlines lie half a pixel further in, for each pixel counts as touched; twice 0.6 px about
    # that, and where tangent cones meet at an angle the depth is the lesser of two
    px = pixel_mm(cameras, REACH) / rig.radius_mm * 32
    assert np.abs(difference + 0.5 * px).max() < 1.2 * px
    far = np.abs(distances - exact) > 3 / 32
    assert ((depth.ravel() > 0) == (distances < exact))[far].all()


@pytest.mark.parametrize("width", [1, 2, 3, 4])
def test_the_range_about_a_pixel_is_what_a_filter_says(width):
    rgb = np.random.default_rng(0).integers(0, 256, (2, 9, 7, 3), np.uint8)
    size = (1, width, width, 1)
    for result, slow in zip(
        color_ranges(rgb, width), (minimum_filter, maximum_filter), strict=True
    ):
        np.testing.assert_array_equal(result, slow(rgb, size=size, mode="nearest"))


def test_exposed_cells_are_those_that_miss_a_neighbor():
    solid = np.zeros((9, 9, 9), np.uint8)
    solid[2:7, 2:7, 2:7] = 1
    result = np.stack(np.unravel_index(surface_voxels(solid), solid.shape), axis=1)
    assert len(result) == 5**3 - 3**3
    assert (np.abs(result - 4).max(axis=1) == 2).all()


def test_a_carved_half_ends_where_it_ends_and_leaves_no_skin():
    hull = np.zeros((24, 24, 24), bool)
    hull[4:20, 4:20, 4:20] = True
    solid = hull.copy()
    solid[:, :, 12:] = False
    depth = depth_in_carved(hull, solid)
    # the last cell left is 11, the first carved is 12; a consistent cell stands out by 0.3
    expected = 11.5 - 0.3 - np.arange(24)
    # a blur of one cell is a normal distribution's: straight within 6 % of half a cell or so
    np.testing.assert_allclose(depth[10, 10, 11:13], expected[11:13], atol=0.06)
    assert (depth[10, 10, 13:21] < -0.5).all()  # also above the hull's own lid
    assert (depth[10, 10, :8] > 1).all()


def test_photographs_that_contradict_all_of_the_solid_are_not_believed():
    """As of shining metal: without the safeguard nothing is left of the cup."""
    noise = np.random.default_rng(0)

    def glitter(at: np.ndarray) -> np.ndarray:
        return noise.integers(0, 250, at.shape)

    result = carve_reconstruction(CUP, glitter, STRICT)
    np.testing.assert_array_equal(result.points_mm, points_of(CUP, gray))
    assert result.warnings[0].endswith(
        "so the result is the visual hull; does the part shine, did a "
        "light move, are cameras inexact?"
    )
    with pytest.raises(ReconstructionFailed, match=r"of \d+ cells 0 are left"):
        points_of(CUP, glitter, replace(STRICT, min_silhouette_coverage=0.0))


@pytest.mark.parametrize(("value", "match"), [(255, "no volume: the silhouettes of 40 views")])
def test_photographs_of_nothing_say_so(value, match):
    loaded = {
        Input.RGB: np.full((40, 192, 192, 3), value, np.uint8),
        Input.BACKGROUND: np.ones((40, 3)),
    }
    with pytest.raises(ReconstructionFailed, match=match):
        reconstruct(MethodInputs("carve", CAMERAS, CAMERAS, loaded), SETTINGS, None, 0)


def test_it_is_given_color_and_no_mask():
    assert load_method("carve").inputs == {Input.RGB, Input.BACKGROUND}
