"""A part that fills little of its ball gets a finer grid, and no more points than asked for."""

import pytest

from industnerf.errors import BadParams
from industnerf.methods.industnerf.point_levels import grid_spacing, initial_grid
from industnerf.methods.industnerf_plus.adaptive_resolution import (
    MAX_REFINEMENT,
    adapt_resolution,
    hull_margin,
)
from industnerf.methods.industnerf_plus.silhouette_carving import Silhouettes
from tests.methods.industnerf.synthetic_scenes import (
    ball,
    box,
    make_silhouettes,
    make_test_scene,
    settings,
)

RES = 24


@pytest.fixture(scope="module")
def rod() -> Silhouettes:
    return make_silhouettes(make_test_scene(box((3.0, 3.0, 18.0)), 12, 64))


def points_inside(silhouettes: Silhouettes, config) -> int:
    spacing = grid_spacing(config.grid_res, 0)
    points = initial_grid(spacing, silhouettes.device)
    return int(silhouettes.inside_hull(points, hull_margin(config) * spacing).sum())


def plus_settings(grid_points: int):
    return settings("industnerf_plus", grid_res=RES, max_grid_points=grid_points)


def test_no_more_points_than_asked_for_and_not_many_fewer(rod):
    usual = points_inside(rod, plus_settings(0))
    for ratio in (1.5, 2.0, 4.0):
        requested = int(ratio * usual)
        config = adapt_resolution(plus_settings(requested), rod)
        assert RES < config.grid_res <= MAX_REFINEMENT * RES
        # all of it grows as r^3 at most, and a skin at least as r^2; one step of r is 1/24 of it
        assert ratio ** (2 / 3) * (1 - 3 / RES) * usual <= points_inside(rod, config) <= requested


def test_a_part_that_fills_its_ball_keeps_its_grid(rod):
    full = make_silhouettes(make_test_scene(ball(19.0), 12, 64))
    requested = points_inside(rod, plus_settings(0)) * 2
    assert adapt_resolution(plus_settings(requested), full) == plus_settings(requested)
    assert adapt_resolution(plus_settings(0), rod) == plus_settings(0)


def test_the_grid_is_at_most_so_much_finer(rod):
    assert adapt_resolution(plus_settings(10**9), rod).grid_res == MAX_REFINEMENT * RES


def test_a_grid_that_is_warmed_up_can_be_halved(rod):
    warm = {"steps": 5, "image_px": 32}
    for ratio in (1.5, 1.7, 2.0):
        requested = int(ratio * points_inside(rod, plus_settings(0)))
        config = settings("industnerf_plus", grid_res=RES, max_grid_points=requested, warm_up=warm)
        assert adapt_resolution(config, rod).grid_res % 2 == 0
    with pytest.raises(BadParams, match="grid_res is 25, must be even"):
        settings("industnerf_plus", grid_res=25, warm_up=warm)


def test_light_reaches_as_deep_at_first_whatever_the_grid(rod):
    before, after = plus_settings(10**9), adapt_resolution(plus_settings(10**9), rod)
    depths = [config.beta.start * grid_spacing(config.grid_res, 0) for config in (before, after)]
    assert depths[0] == pytest.approx(depths[1], rel=1e-12)


def test_without_silhouettes_nobody_knows_how_many_points_may_hold_matter():
    with pytest.raises(BadParams, match=r"max_grid_points.*silhouette_carving"):
        settings("industnerf_plus", max_grid_points=1000, silhouette_carving=False)
