"""The first grid, cells and their halves, and what is near."""

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from industnerf.errors import BadParams, ReconstructionFailed
from industnerf.methods.industnerf.point_levels import (
    PointLevel,
    cell_indices,
    grid_mean,
    grid_spacing,
    initial_grid,
    sample_points,
    subdivide,
    within_radius,
)
from tests.methods.industnerf.synthetic_scenes import CPU, settings

SEEDS = st.integers(0, 2**32 - 1)


def cloud(seed: int, count: int) -> torch.Tensor:
    return torch.rand(count, 3, generator=torch.Generator().manual_seed(seed)) * 2 - 1


@pytest.mark.parametrize("grid_res", [8, 13])
def test_the_first_grid_is_the_cells_about_the_unit_ball(grid_res):
    spacing = grid_spacing(grid_res, 0)
    points = initial_grid(spacing, CPU)
    assert len(torch.unique(points, dim=0)) == len(points)
    cells = (points + 1) / spacing
    torch.testing.assert_close(cells - 0.5, (cells - 0.5).round(), rtol=0, atol=1e-5)  # centers
    # every place of the ball is in the cell of some point: half a side away at most, each axis
    inside = cloud(0, 3000)
    inside = inside[inside.norm(dim=1) < 1]
    off = (inside[:, None] - points).abs().amax(dim=2).min(dim=1).values
    assert (off < spacing / 2 + 1e-6).all()
    assert (points.norm(dim=1) < 1 + spacing).all()


def test_each_level_halves_the_spacing():
    assert [grid_spacing(16, level) for level in range(-1, 3)] == [1 / 4, 1 / 8, 1 / 16, 1 / 32]


@given(SEEDS)
def test_cells_hold_the_mean_of_their_points(seed):
    points, values = cloud(seed, 40), cloud(seed + 1, 40)[:, 0]
    actual = grid_mean(points, values, 3)
    for cell in np.ndindex(3, 3, 3):
        lo = torch.tensor(cell) * 2 / 3 - 1
        inside = ((points >= lo) & (points < lo + 2 / 3)).all(dim=1)
        expected = values[inside].mean() if inside.any() else torch.tensor(0.0)
        torch.testing.assert_close(
            actual[cell], expected, rtol=0, atol=1e-6
        )  # float32, in any order


def test_the_last_cell_has_the_boundary_and_what_is_beyond():
    edge = torch.tensor([[1.0, -1, 0], [1.2, -1.3, 0.1]])
    assert cell_indices(edge, 4).tolist() == [[3, 0, 2], [3, 0, 2]]


def test_samples_lie_in_cells_with_density_in_proportion():
    """Two of 6^3 cells have density, as 1 to 3."""
    points = torch.tensor([[-0.5, 0.5, 0.17], [0.83, -0.17, -0.83]])
    density = grid_mean(points, torch.tensor([1.0, 3]), 6)
    drawn = sample_points(density, 800, torch.Generator().manual_seed(0), "jitter")
    cell = cell_indices(drawn, 6)
    counts = [(cell == cell_indices(points, 6)[i]).all(dim=1).sum().item() for i in range(2)]
    # x alone tells the cells apart, and its uniforms are stratified: exact but for the strata
    # that the border cuts
    np.testing.assert_allclose(counts, [200, 600], atol=1)
    assert sum(counts) == 800
    assert torch.equal(drawn, drawn.clamp(-1, 1))


def test_samples_are_jittered_or_in_the_middle():
    density = grid_mean(torch.tensor([[0.1, 0.1, 0.1]]), torch.ones(1), 4)
    arguments = (density, 50, torch.Generator().manual_seed(0))
    assert (sample_points(*arguments, "center") == 0.25).all()
    assert len(torch.unique(sample_points(*arguments, "jitter"), dim=0)) == 50


def test_nothing_cannot_be_sampled():
    with pytest.raises(ReconstructionFailed, match="the field is empty"):
        sample_points(torch.zeros(4, 4, 4), 9, torch.Generator(), "center")


def test_a_layers_rows_stay_together():
    points, view_weights = cloud(0, 6), torch.rand(3, 6)
    level = PointLevel(points, 0.1, (points[:, 0], points / 2), view_weights)
    for which in (torch.tensor([4, 1]), points[:, 0] > 0):
        selected = level.select(which)
        assert selected.spacing == 0.1
        assert torch.equal(selected.points, points[which])
        assert torch.equal(selected.residuals[0], points[which, 0])
        assert torch.equal(selected.residuals[1], points[which] / 2)
        assert torch.equal(selected.view_weights, view_weights[:, which])
    bare = PointLevel(points, 0.1).select(torch.tensor([2]))
    assert bare.residuals is None
    assert bare.view_weights is None


@pytest.mark.parametrize("grid_res", [8, 11])
def test_halves_of_the_grid_are_the_next_grid(grid_res):
    """What the grid of half the spacing has, and nothing twice."""
    spacing = grid_spacing(grid_res, 0)
    points = initial_grid(spacing, CPU)
    finer = subdivide(points, spacing)
    assert len(finer) == 8 * len(points)
    cells = cell_indices(finer, 2 * grid_res)
    assert len(torch.unique(cells, dim=0)) == len(finer)
    assert torch.equal(cells // 2, cell_indices(points, grid_res).repeat_interleave(8, dim=0))
    centers = (cells + 0.5) * spacing / 2 - 1
    torch.testing.assert_close(finer, centers, rtol=0, atol=1e-6)


@given(SEEDS, st.floats(0.01, 1))
def test_near_any_is_what_distances_say(seed, reach):
    points = cloud(seed, 60)
    mask = torch.rand(60, generator=torch.Generator().manual_seed(seed)) < 0.1
    apart = (points[:, None] - points[mask]).double().norm(dim=2)
    nearest = apart.min(dim=1).values if mask.any() else torch.full((60,), torch.inf)
    is_unambiguous = (nearest - reach).abs() > 1e-6  # on the edge, either answer will do
    actual = within_radius(points, mask, reach)
    assert torch.equal(actual[is_unambiguous], (nearest < reach)[is_unambiguous])
    assert actual[mask].all()


def test_only_levels_after_the_first_may_have_no_steps():
    settings("nerf", levels=[{"steps": 5}, {"steps": 0}])
    with pytest.raises(BadParams, match=r"levels\[0\]\.steps is 0"):
        settings("nerf", levels=[{"steps": 0}, {"steps": 5}])
