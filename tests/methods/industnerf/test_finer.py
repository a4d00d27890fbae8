"""A part that fills little of its ball gets a finer grid, and no more points than asked for."""

import pytest

from industnerf.errors import BadParams
from industnerf.methods.industnerf.carving import Silhouettes
from industnerf.methods.industnerf.finer import FINEST, as_fine_as_fits, margin
from industnerf.methods.industnerf.levels import grid, spacing_of
from tests.methods.industnerf.scenes import ball, box, scene, settings, silhouettes_of

RES = 24


@pytest.fixture(scope="module")
def rod() -> Silhouettes:
    return silhouettes_of(scene(box((3.0, 3.0, 18.0)), 12, 64))


def held(silhouettes: Silhouettes, ways) -> int:
    spacing = spacing_of(ways.grid_res, 0)
    points = grid(spacing, silhouettes.device)
    return int(silhouettes.may_hold(points, margin(ways) * spacing).sum())


def of_plus(grid_points: int):
    return settings("industnerf_plus", grid_res=RES, grid_points=grid_points)


def test_no_more_points_than_asked_for_and_not_many_fewer(rod):
    usual = held(rod, of_plus(0))
    for share in (1.5, 2.0, 4.0):
        asked = int(share * usual)
        ways = as_fine_as_fits(of_plus(asked), rod)
        assert RES < ways.grid_res <= FINEST * RES
        # all of it grows as r^3 at most, and a skin at least as r^2; one step of r is 1/24 of it
        assert share ** (2 / 3) * (1 - 3 / RES) * usual <= held(rod, ways) <= asked


def test_a_part_that_fills_its_ball_keeps_its_grid(rod):
    full = silhouettes_of(scene(ball(19.0), 12, 64))
    asked = held(rod, of_plus(0)) * 2
    assert as_fine_as_fits(of_plus(asked), full) == of_plus(asked)
    assert as_fine_as_fits(of_plus(0), rod) == of_plus(0)


def test_the_grid_is_at_most_so_much_finer(rod):
    assert as_fine_as_fits(of_plus(10**9), rod).grid_res == FINEST * RES


def test_a_grid_that_is_warmed_up_can_be_halved(rod):
    warm = {"steps": 5, "image_px": 32}
    for share in (1.5, 1.7, 2.0):
        asked = int(share * held(rod, of_plus(0)))
        ways = settings("industnerf_plus", grid_res=RES, grid_points=asked, warm_up=warm)
        assert as_fine_as_fits(ways, rod).grid_res % 2 == 0
    with pytest.raises(BadParams, match="grid_res is 25, must be even"):
        settings("industnerf_plus", grid_res=25, warm_up=warm)


def test_light_reaches_as_deep_at_first_whatever_the_grid(rod):
    before, after = of_plus(10**9), as_fine_as_fits(of_plus(10**9), rod)
    deep = [ways.softness.first * spacing_of(ways.grid_res, 0) for ways in (before, after)]
    assert deep[0] == pytest.approx(deep[1], rel=1e-12)


def test_without_silhouettes_nobody_knows_how_many_points_may_hold_matter():
    with pytest.raises(BadParams, match=r"grid_points.*carve"):
        settings("industnerf", grid_points=1000)
