"""Where `industnerf_plus` starts: a cup that is painted, one that is not, and noise."""

from dataclasses import replace

import numpy as np
import pytest
import torch

from industnerf.geometry.cameras import common_view_ball
from industnerf.methods.industnerf.scene import PosedImages, make_scene
from industnerf.methods.industnerf_plus.photo_hull import (
    GRID_RES_MULTIPLE,
    MIN_GRID_RES,
    PhotoHull,
    limit_grid_res,
    signed_depth_grid,
)
from industnerf.schema.carving import CARVING_GRID_RES
from tests.methods.industnerf.synthetic_scenes import make_silhouettes, settings
from tests.methods.solids import cameras_around, cup, render_painted

SETTINGS = replace(settings("industnerf_plus").sdf.init, grid_res=64)
CAMERAS = cameras_around(40, 192, 30.0)
CENTER, RADIUS = common_view_ball(CAMERAS)
CELL = 2 / SETTINGS.grid_res
FLOOR, RIM, INNER = -6.0, 12.0, 13.0  # mm
CUP = cup(18.0, INNER, 24.0, 6.0)


def waves(points: np.ndarray) -> np.ndarray:
    return 110 + 80 * np.sin(points * [0.9, 0.7, 0.8])


def gray(points: np.ndarray) -> np.ndarray:
    return np.full(points.shape, 120)


def make_photo_hull(rgb: np.ndarray, **changed: float) -> PhotoHull:
    images = PosedImages(rgb, CAMERAS, np.ones((len(CAMERAS), 3)), CENTER, RADIUS)
    outlines = make_silhouettes(make_scene(images, torch.device("cpu"))).outlines()
    return PhotoHull(images, outlines, replace(SETTINGS, **changed))


def in_the_pocket() -> tuple[np.ndarray, torch.Tensor]:
    """Two cells or more from wall, floor and rim; mm, and in the scene's unit."""
    points_mm = np.random.default_rng(0).uniform([-9, -9, FLOOR + 3], [9, 9, RIM - 3], (500, 3))
    return points_mm, torch.from_numpy((points_mm - CENTER) / RADIUS).float()


def test_the_pocket_of_a_painted_cup_is_open_from_the_start():
    """Its floor keeps up to 4 cells where no three views see it straight (test_carve)."""
    points_mm, points = in_the_pocket()
    outside = make_photo_hull(render_painted(CUP, CAMERAS, waves)[1]).distance(points).numpy()
    assert make_photo_hull(render_painted(CUP, CAMERAS, waves)[1]).warnings == ()
    high = points_mm[:, 2] > FLOOR + 4 * CELL * RADIUS
    to_wall = (INNER - np.hypot(points_mm[:, 0], points_mm[:, 1])) / RADIUS
    assert (outside[high] > 0).all()
    # a cell of the wall is left where it is consistent, and one may stay that is beside it
    assert (outside <= to_wall + 1.5 * CELL).all()


def test_where_the_photographs_say_nothing_it_is_the_visual_hull():
    _, points = in_the_pocket()
    assert (make_photo_hull(render_painted(CUP, CAMERAS, gray)[1]).distance(points) < 0).all()


def test_when_the_photographs_contradict_all_of_it_it_is_the_visual_hull():
    rgb = render_painted(CUP, CAMERAS, gray)[1]
    noise = np.random.default_rng(0).integers(0, 250, rgb.shape, np.uint8)
    strict = {
        "color_threshold": 0.0,
        "outlier_fraction": 0.0,
        "voxel_footprint": 0.3,
        "min_view_cosine": -0.9,
        "max_sweeps": 200,
    }
    hull = make_photo_hull(np.where(rgb < 255, noise, rgb), **strict)
    _, points = in_the_pocket()
    assert (hull.distance(points) < 0).all()
    assert not hull.is_reliable
    [warning] = hull.warnings
    assert warning.startswith("the photographs contradict the silhouettes")


def test_silhouettes_that_contradict_each_other_are_spoken_of():
    """Half of the views glint in the background's color over the upper half of the picture."""
    rgb = render_painted(CUP, CAMERAS, waves)[1]
    rgb[::2, :96] = 255
    assert (
        make_photo_hull(rgb).warnings[0].startswith("the silhouettes contradict each other: their ")
    )


@pytest.mark.parametrize(("px", "cells"), [(512.0, 128), (200.0, 96), (128.0, 64), (40.0, 32)])
def test_cells_are_two_pixels_wide_or_more(px, cells):
    fit = limit_grid_res(replace(SETTINGS, grid_res=128), px)
    assert fit.grid_res == cells
    assert CARVING_GRID_RES.is_valid(fit.grid_res)


def test_cells_are_as_coarse_as_the_schema_lets_them_be():
    assert CARVING_GRID_RES.is_valid(MIN_GRID_RES)
    assert not CARVING_GRID_RES.is_valid(MIN_GRID_RES - GRID_RES_MULTIPLE)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_depth_in_a_slab_is_that_of_its_faces(axis):
    """Cells 3 to 6 of 12 are solid: its faces are at 2.5 and 6.5."""
    at = np.arange(12)
    solid = np.zeros((12, 12, 12), bool)
    np.moveaxis(solid, axis, 0)[3:7] = True
    depth = np.moveaxis(signed_depth_grid(solid), axis, 0)[:, 5, 5]
    np.testing.assert_allclose(depth, np.minimum(at - 2.5, 6.5 - at))
