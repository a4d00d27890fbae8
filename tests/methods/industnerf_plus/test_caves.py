"""Hollows that the pictures do not show are filled; recesses that they show are not."""

from dataclasses import replace

import numpy as np
import pytest

from industnerf.config import load_params
from industnerf.geometry.cameras import Cameras, look_at, pinhole
from industnerf.geometry.sphere import fibonacci_sphere
from industnerf.methods.industnerf_plus.caves import caves, fill_caves, pixels_behind, unseen_air
from industnerf.methods.industnerf_plus.pictures import Pictures
from industnerf.methods.industnerf_plus.shaded_surface import PinholeRays
from industnerf.methods.industnerf_plus.trials import Trials

from .plugged_block import BLOCK, CENTERED, POCKET, VIEWS, photographs, surface_of

SETTINGS = load_params().method.industnerf_plus.caves
HOLLOW = np.linalg.norm(CENTERED - [-4, 3, -2], axis=-1) - 7.5
CRACK = np.maximum(np.hypot(CENTERED[..., 0] + 4, CENTERED[..., 1] - 3) - 1.2, -CENTERED[..., 2])
CAVE = np.minimum(HOLLOW, CRACK)
BORE = np.maximum(np.hypot(CENTERED[..., 0] - 5, CENTERED[..., 1] + 4) - 4.2, -CENTERED[..., 2])


def fill(field: np.ndarray, true: np.ndarray) -> tuple[int, np.ndarray]:
    """How many caves are filled, and where matter is then."""
    surface = surface_of(field)
    rays = PinholeRays(VIEWS, np.zeros(3), 1.0, surface.grid)
    number = fill_caves(surface, rays, photographs(true), SETTINGS)
    is_solid = surface.distance.numpy() < 0
    assert not is_solid[surface.grid.hull > 0].any()
    return number, is_solid


def test_a_hollow_behind_a_crack_is_filled():
    number, is_solid = fill(np.maximum(BLOCK, -CAVE), BLOCK)
    assert number >= 1
    assert is_solid[(HOLLOW < 0) & (BLOCK < -1)].mean() > 0.98


@pytest.mark.parametrize("recess", [POCKET, BORE], ids=["pocket", "blind bore"])
def test_what_the_pictures_show_stays_open(recess):
    field = np.maximum(BLOCK, -recess)
    _, is_solid = fill(field, field)
    assert not is_solid[(recess < -0.5) & (BLOCK < -0.5)].any()


def test_air_that_no_ray_passes_is_unseen():
    assert unseen_share(CAVE, HOLLOW < -3) > 0.7
    assert unseen_share(POCKET, POCKET < -1) == 0


def unseen_share(recess: np.ndarray, where: np.ndarray) -> float:
    surface = surface_of(np.maximum(BLOCK, -recess))
    rays = PinholeRays(VIEWS, np.zeros(3), 1.0, surface.grid)
    return float(unseen_air(Trials(surface, rays, photographs(BLOCK)))[where].mean())


def test_a_ball_tells_hollows_from_grooves():
    """A groove that the ball enters is none, and an edge that it cannot reach into neither."""
    everything = np.ones(BLOCK.shape, bool)
    groove = np.maximum(np.abs(CENTERED[..., 0]) - 6, -CENTERED[..., 2])
    field = surface_of(np.maximum(BLOCK, -groove)).distance.numpy()
    assert list(caves(field, everything, 2.0, 0.5)) == []
    hollow = surface_of(np.maximum(BLOCK, -CAVE)).distance.numpy()
    ((nodes, closed),) = caves(hollow, everything, 2.0, 0.5)
    assert (closed < 0).mean() > 0.7
    is_in = np.zeros(BLOCK.shape, bool)
    is_in[tuple(nodes.T)] = True
    assert is_in[HOLLOW < -1].all()
    assert list(caves(hollow, ~everything, 2.0, 0.5)) == []


def test_nothing_is_filled_where_the_settings_say_so():
    surface = surface_of(np.maximum(BLOCK, -CAVE))
    rays = PinholeRays(VIEWS, np.zeros(3), 1.0, surface.grid)
    settings = replace(SETTINGS, max_cost_ratio=0.0)
    assert fill_caves(surface, rays, photographs(BLOCK), settings) == 0


@pytest.mark.parametrize("px", [160, 640], ids=["2 px a cell", "9 px a cell"])
def test_all_pixels_that_show_the_nodes_judge(px):
    cameras = Cameras(
        np.repeat(pinhole(30.0, px)[None], 3, 0),
        look_at(4.0 * fibonacci_sphere(3), np.zeros(3)),
        px,
        px,
    )
    images, background = np.zeros((3, px, px, 3), np.uint8), np.ones((3, 3))
    pictures = Pictures(images, background, np.full((3, px, px), 5, np.float32))
    surface = surface_of(BLOCK)
    trials = Trials(surface, PinholeRays(cameras, np.zeros(3), 1.0, surface.grid), pictures)
    nodes = np.argwhere(np.abs(surface.distance.numpy()) < 2)
    shown = np.flatnonzero(trials.ends > 0)
    assert len(shown) > 100
    assert np.isin(shown, pixels_behind(trials, nodes)).all()
