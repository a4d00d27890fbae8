"""Where `industnerf_plus` starts: a cup that is painted, one that is not, and noise."""

from dataclasses import replace

import numpy as np
import pytest
import torch

from industnerf.geometry.cameras import framed_ball
from industnerf.methods.industnerf.photohull import (
    BLOCK,
    COARSEST,
    PhotoHull,
    depth_in,
    of_two_pixels,
)
from industnerf.methods.industnerf.scene import Posed, scene_of
from industnerf.schema.carving import BLOCKS
from tests.methods.industnerf.scenes import settings, silhouettes_of
from tests.methods.solids import cameras_around, cup, painted

WAYS = replace(settings("industnerf_plus").relief.start, grid_res=64)
CAMERAS = cameras_around(40, 192, 30.0)
CENTRE, RADIUS = framed_ball(CAMERAS)
CELL = 2 / WAYS.grid_res
FLOOR, RIM, INNER = -6.0, 12.0, 13.0  # mm
CUP = cup(18.0, INNER, 24.0, 6.0)


def waves(points: np.ndarray) -> np.ndarray:
    return 110 + 80 * np.sin(points * [0.9, 0.7, 0.8])


def grey(points: np.ndarray) -> np.ndarray:
    return np.full(points.shape, 120)


def photo_hull(rgb: np.ndarray, **changed: float) -> PhotoHull:
    posed = Posed(rgb, CAMERAS, np.ones((len(CAMERAS), 3)), CENTRE, RADIUS)
    outlines = silhouettes_of(scene_of(posed, torch.device("cpu"))).outlines()
    return PhotoHull(posed, outlines, replace(WAYS, **changed))


def in_the_pocket() -> tuple[np.ndarray, torch.Tensor]:
    """Two cells or more from wall, floor and rim; mm, and in the scene's unit."""
    places = np.random.default_rng(0).uniform([-9, -9, FLOOR + 3], [9, 9, RIM - 3], (500, 3))
    return places, torch.from_numpy((places - CENTRE) / RADIUS).float()


def test_the_pocket_of_a_painted_cup_is_open_from_the_start():
    """Its floor keeps up to 4 cells where no three views see it straight (test_carve)."""
    places, points = in_the_pocket()
    outside = photo_hull(painted(CUP, CAMERAS, waves)[1]).distance(points).numpy()
    assert photo_hull(painted(CUP, CAMERAS, waves)[1]).remarks == ()
    high = places[:, 2] > FLOOR + 4 * CELL * RADIUS
    to_wall = (INNER - np.hypot(places[:, 0], places[:, 1])) / RADIUS
    assert (outside[high] > 0).all()
    # a cell of the wall is left where it is consistent, and one may stay that is beside it
    assert (outside <= to_wall + 1.5 * CELL).all()


def test_where_the_photographs_say_nothing_it_is_the_visual_hull():
    _, points = in_the_pocket()
    assert (photo_hull(painted(CUP, CAMERAS, grey)[1]).distance(points) < 0).all()


def test_when_the_photographs_contradict_all_of_it_it_is_the_visual_hull():
    rgb = painted(CUP, CAMERAS, grey)[1]
    noise = np.random.default_rng(0).integers(0, 250, rgb.shape, np.uint8)
    strict = {"threshold": 0.0, "outliers": 0.0, "footprint": 0.3, "facing": -0.9, "sweeps": 200}
    hull = photo_hull(np.where(rgb < 255, noise, rgb), **strict)
    _, points = in_the_pocket()
    assert (hull.distance(points) < 0).all()
    assert not hull.believed
    [said] = hull.remarks
    assert said.startswith("the photographs contradict the silhouettes")


def test_silhouettes_that_contradict_each_other_are_spoken_of():
    """Half of the views glint in the background's colour over the upper half of the picture."""
    rgb = painted(CUP, CAMERAS, waves)[1]
    rgb[::2, :96] = 255
    assert photo_hull(rgb).remarks[0].startswith("the silhouettes contradict each other: their ")


@pytest.mark.parametrize(("px", "cells"), [(512.0, 128), (200.0, 96), (128.0, 64), (40.0, 32)])
def test_cells_are_two_pixels_wide_or_more(px, cells):
    fit = of_two_pixels(replace(WAYS, grid_res=128), px)
    assert fit.grid_res == cells
    assert BLOCKS.holds(fit.grid_res)


def test_cells_are_as_coarse_as_the_schema_lets_them_be():
    assert BLOCKS.holds(COARSEST)
    assert not BLOCKS.holds(COARSEST - BLOCK)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_depth_in_a_slab_is_that_of_its_faces(axis):
    """Cells 3 to 6 of 12 are solid: its faces are at 2.5 and 6.5."""
    at = np.arange(12)
    solid = np.zeros((12, 12, 12), bool)
    np.moveaxis(solid, axis, 0)[3:7] = True
    depth = np.moveaxis(depth_in(solid), axis, 0)[:, 5, 5]
    np.testing.assert_allclose(depth, np.minimum(at - 2.5, 6.5 - at))
