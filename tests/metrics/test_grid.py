"""The grid of protocols on clouds whose distances are known."""

import numpy as np
import pytest

from industnerf.metrics.compare import Sampled
from industnerf.metrics.emd import emd
from industnerf.metrics.grid import grid
from industnerf.metrics.reduce import farthest_points


def sides(count=3000, shift=0.02):
    """A flat square, and the same shifted; the second half of either is hidden."""
    rng = np.random.default_rng(0)
    points = np.column_stack([rng.uniform(size=(count, 2)), np.zeros(count)])
    kept = np.arange(count) < count // 2
    return Sampled(points, kept), Sampled(points + np.array([0.0, 0.0, shift]), kept)


def cells(points=(256, 512), diagonals=1.5, **what):
    found = grid(*sides(**what), diagonals, points, np.random.default_rng(0))
    return {(c.points, c.reduction, c.surface, c.cost, c.scale): c.value for c in found}


def test_there_is_a_cell_for_every_protocol():
    assert len(cells()) == 2 * 2 * 2 * 2 * 2


def test_of_two_parallel_planes_every_even_cell_is_their_distance():
    # the same farthest points are chosen of both, so that each is carried straight up
    found = cells()
    for n in (256, 512):
        for surface in ("visible", "full"):
            assert found[n, "even", surface, "distance", "diagonal"] == pytest.approx(0.02)
            assert found[n, "even", surface, "squared", "diagonal"] == pytest.approx(0.02**2)


def test_another_unit_is_a_factor_and_its_square():
    found = cells(diagonals=1.5)
    one, two = (("even", "visible", cost) for cost in ("distance", "squared"))
    assert found[256, *one, "longest"] == pytest.approx(1.5 * found[256, *one, "diagonal"])
    assert found[256, *two, "longest"] == pytest.approx(2.25 * found[256, *two, "diagonal"])


def test_chance_costs_what_even_spacing_does_not():
    truth, _ = sides()
    found = grid(truth, truth, 1.0, (256, 512), np.random.default_rng(5))
    assert max(c.value for c in found if c.reduction == "even") == pytest.approx(0, abs=1e-12)
    assert min(c.value for c in found if c.reduction == "iid") > 1e-6


def test_a_visible_cell_is_of_the_visible_points_alone():
    truth, shown = sides()
    far = Sampled(np.where(shown.kept[:, None], shown.points, shown.points + 5), shown.kept)
    found = grid(truth, far, 1.0, (256,), np.random.default_rng(0))
    value = {(c.reduction, c.surface, c.cost, c.scale): c.value for c in found}
    assert value["even", "visible", "distance", "diagonal"] == pytest.approx(0.02)
    expected = emd(farthest_points(truth.points, 256), farthest_points(far.points, 256))
    assert value["even", "full", "distance", "diagonal"] == expected > 1


def test_a_cell_that_wants_more_points_than_there_are_is_left_out():
    assert {key[2] for key in cells(points=(2000,))} == {"full"}
