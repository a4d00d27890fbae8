"""Recesses are cut along the normals of faces, as deep as the pictures show them."""

import numpy as np
import pytest

from industnerf.config import load_params
from industnerf.methods.industnerf_plus.face_maps import RASTER, end_lattice, map_face
from industnerf.methods.industnerf_plus.faces import Face
from industnerf.methods.industnerf_plus.recesses import Recess, _Cutter, cut_recesses
from industnerf.methods.industnerf_plus.shaded_surface import PinholeRays, ShadedSurface
from industnerf.methods.industnerf_plus.trials import Trials

from .plugged_block import (
    BLOCK,
    CENTERED,
    POCKET,
    SIZE,
    TOP,
    VIEWS,
    photographs,
    photographs_of,
    surface_of,
)

SETTINGS = load_params().method.industnerf_plus.recesses
BORE = np.maximum(np.hypot(CENTERED[..., 0] + 4, CENTERED[..., 1] - 3) - 5.2, -CENTERED[..., 2] - 2)
THROUGH = np.hypot(CENTERED[..., 0] - 3, CENTERED[..., 2] + 1) - 4.6


def cut(surface: ShadedSurface, true: np.ndarray) -> int:
    rays = PinholeRays(VIEWS, np.zeros(3), 1.0, surface.grid)
    return cut_recesses(surface, rays, photographs(true), SETTINGS)


@pytest.mark.parametrize(
    "recess",
    [
        pytest.param(-POCKET, id="pocket with a floor as bright as its rim"),
        pytest.param(-np.maximum(BORE, CENTERED[..., 2] - 40), id="blind bore"),
        pytest.param(-THROUGH, id="through bore"),
    ],
)
def test_a_plugged_recess_is_cut_to_its_floor(recess):
    """A mouth is known to a pixel, a third of a cell, and a depth to a tenth of itself."""
    true = np.maximum(BLOCK, recess)
    surface = surface_of(BLOCK)
    assert cut(surface, true) >= 1
    plugged = (BLOCK < 0) & (recess > 0)
    wrong = (surface.distance.numpy() > 0) != (true > 0)
    assert wrong.sum() < 0.3 * plugged.sum()
    is_solid = (BLOCK < -1) & (recess < -1.5)
    assert (surface.distance.numpy()[is_solid] < 0).mean() > 0.999
    assert (surface.distance.numpy() >= surface.grid.hull).all()


def test_nothing_is_cut_where_there_is_nothing():
    surface = surface_of(BLOCK)
    before = surface.distance.numpy().copy()
    assert cut(surface, BLOCK) == 0
    np.testing.assert_array_equal(surface.distance.numpy(), before)


def test_a_recess_has_the_finish_that_is_nearest():
    """The left of two is half as bright, and has the bore."""
    true = np.maximum(BLOCK, -np.maximum(BORE, CENTERED[..., 2] - 40))
    surface, truth = surface_of(BLOCK, finishes=2), surface_of(true, finishes=2)
    for each in (surface, truth):
        points = np.array([[24.0, 28, 28], [44.0, 28, 28]])
        each.set_albedo(points, np.array([[0.5] * 3, [1.0] * 3]))
    rays = PinholeRays(VIEWS, np.zeros(3), 1.0, surface.grid)
    assert cut_recesses(surface, rays, photographs_of(truth), SETTINGS) == 1
    wrong = (surface.distance.numpy() > 0) != (true > 0)
    assert wrong.sum() < 0.3 * ((BLOCK < 0) & (true > 0)).sum()


def test_a_node_far_inside_has_the_finish_of_the_nearest_surface():
    surface = surface_of(BLOCK, finishes=2)
    points = np.array([[24.0, 28, 28], [44.0, 28, 28]])
    surface.set_albedo(points, np.array([[0.5] * 3, [0.8] * 3]))
    inside = surface._albedo.numpy()[BLOCK < -9]  # the surface's own nodes end 8 cells from it
    assert len(inside)
    assert np.isin(inside, np.float32([0.5, 0.8])).all()


def test_without_light_nothing_is_cut():
    surface = surface_of(BLOCK)
    surface.without_light()
    assert cut(surface, np.maximum(BLOCK, -POCKET)) == 0


def test_a_mouth_that_the_pictures_do_not_confirm_is_not_cut():
    surface = surface_of(BLOCK)
    rays = PinholeRays(VIEWS, np.zeros(3), 1.0, surface.grid)
    trials = Trials(surface, rays, photographs(BLOCK))
    face = Face(np.array([0.0, 0.0, 1.0]), TOP + (SIZE - 1) / 2, 1000)
    plain = map_face(trials, face, end_lattice(trials), 0.03)
    away = np.linalg.norm(np.indices(plain.is_face.shape) - np.full((2, 1, 1), 37.0), axis=0)
    cutter = _Cutter(trials, SETTINGS.rays_per_trial)
    cutter.propose(plain, (5 - RASTER * away).astype(np.float32), SETTINGS.max_cost_ratio)
    assert cutter.cut() == 0
    np.testing.assert_array_equal(trials.distance, surface_of(BLOCK).distance.numpy())


def test_some_pixels_estimate_what_all_of_them_gain():
    """Of some 700 pixels every seventh or so: an error of a tenth is one of two deviations."""
    true = np.maximum(BLOCK, -POCKET)
    surface = surface_of(BLOCK)
    trials = Trials(surface, PinholeRays(VIEWS, np.zeros(3), 1.0, surface.grid), photographs(true))
    face = Face(np.array([0.0, 0.0, 1.0]), TOP + (SIZE - 1) / 2, 1000)
    face_map = map_face(trials, face, end_lattice(trials), 0.03)
    recess = Recess(face_map, face_map.mouths()[0], 30.0, 0.92, depth=8.0)
    full, some = (_Cutter(trials, rays)._gain(recess) for rays in (1 << 30, 100))
    assert full > 0
    assert some != full
    assert some == pytest.approx(full, rel=0.25)
