"""The grid of protocols on clouds whose distances are known."""

import numpy as np
import pytest

from industnerf.metrics.emd import emd
from industnerf.metrics.protocol_grid import emd_grid
from industnerf.metrics.subsample import farthest_points
from industnerf.metrics.surface_samples import SampledSurface


def surface_pair(count=3000, shift=0.02):
    """A flat square, and the same shifted; the second half of either is hidden."""
    rng = np.random.default_rng(0)
    points = np.column_stack([rng.uniform(size=(count, 2)), np.zeros(count)])
    evaluated = np.arange(count) < count // 2
    return SampledSurface(points, evaluated), SampledSurface(
        points + np.array([0.0, 0.0, shift]), evaluated
    )


def cells_by_protocol(points=(256, 512), diagonals=1.5, **what):
    grid_cells = emd_grid(*surface_pair(**what), diagonals, points, np.random.default_rng(0))
    return {(c.points, c.reduction, c.surface, c.cost, c.scale): c.value for c in grid_cells}


def test_there_is_a_cell_for_every_protocol():
    assert len(cells_by_protocol()) == 2 * 2 * 2 * 2 * 2


def test_of_two_parallel_planes_every_even_cell_is_their_distance():
    # the same farthest points are chosen of both, so that each is carried straight up
    grid_cells = cells_by_protocol()
    for n in (256, 512):
        for surface in ("visible", "full"):
            assert grid_cells[n, "even", surface, "distance", "diagonal"] == pytest.approx(0.02)
            assert grid_cells[n, "even", surface, "squared", "diagonal"] == pytest.approx(0.02**2)


def test_another_unit_is_a_factor_and_its_square():
    grid_cells = cells_by_protocol(diagonals=1.5)
    one, two = (("even", "visible", cost) for cost in ("distance", "squared"))
    assert grid_cells[256, *one, "longest"] == pytest.approx(
        1.5 * grid_cells[256, *one, "diagonal"]
    )
    assert grid_cells[256, *two, "longest"] == pytest.approx(
        2.25 * grid_cells[256, *two, "diagonal"]
    )


def test_chance_costs_what_even_spacing_does_not():
    truth, _ = surface_pair()
    grid_cells = emd_grid(truth, truth, 1.0, (256, 512), np.random.default_rng(5))
    assert max(c.value for c in grid_cells if c.reduction == "even") == pytest.approx(0, abs=1e-12)
    assert min(c.value for c in grid_cells if c.reduction == "iid") > 1e-6


def test_a_visible_cell_is_of_the_visible_points_alone():
    truth, visible_surface = surface_pair()
    far = SampledSurface(
        np.where(
            visible_surface.evaluated[:, None], visible_surface.points, visible_surface.points + 5
        ),
        visible_surface.evaluated,
    )
    grid_cells = emd_grid(truth, far, 1.0, (256,), np.random.default_rng(0))
    value = {(c.reduction, c.surface, c.cost, c.scale): c.value for c in grid_cells}
    assert value["even", "visible", "distance", "diagonal"] == pytest.approx(0.02)
    expected = emd(farthest_points(truth.points, 256), farthest_points(far.points, 256)).value
    assert value["even", "full", "distance", "diagonal"] == expected > 1


def test_a_cell_that_wants_more_points_than_there_are_is_left_out():
    assert {key[2] for key in cells_by_protocol(points=(2000,))} == {"full"}
