"""The next level's points: near what is sure, inside the box, with what they take over."""

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from industnerf.errors import ReconstructionFailed
from industnerf.methods.industnerf.confidence import ObservedSurface, ViewConfidence
from industnerf.methods.industnerf.field import Field
from industnerf.methods.industnerf.point_levels import (
    WARM_UP,
    PointLevel,
    cell_indices,
    grid_spacing,
    initial_grid,
)
from industnerf.methods.industnerf.refine import nearest_indices, refine_points
from industnerf.methods.industnerf.trainer import Trainer
from tests.methods.industnerf.synthetic_scenes import (
    CPU,
    FREE_POINTS,
    WITH_RESIDUAL,
    ball,
    make_test_scene,
    settings,
)

EMPTY_SURFACE = ObservedSurface(
    torch.zeros(0, 3), torch.zeros(0, 3), torch.zeros(0), torch.zeros(0).long()
)
RES = 10
TWO = [{}, {"points": 1500}]


def make_trainer(refine: str, level: int = 0, **changes) -> Trainer:
    config = settings("industnerf", refine=refine, grid_res=RES, levels=TWO, **changes)
    views = make_test_scene(ball(18.0), 3, 24)
    field = Field(views, config)
    level_points = PointLevel(initial_grid(grid_spacing(RES, level), CPU), grid_spacing(RES, level))
    return Trainer(views, field, level_points, level, config, torch.Generator())


def fill_ball(trainer: Trainer, radius: float) -> torch.Tensor:
    """Makes points dense within `radius`, and each residual unlike any other."""
    has_density = trainer.points.positions.norm(dim=1) < radius
    count = len(has_density)
    with torch.no_grad():
        trainer.field.raw.copy_(torch.linspace(0, 1, count).where(has_density, -7.0))
        trainer.field.rgb.copy_(torch.rand(count, 3, generator=torch.Generator().manual_seed(0)))
    return has_density


def make_view_confidence(confidence: torch.Tensor) -> ViewConfidence:
    """Three views, of which the second is as sure as this."""
    per_view = torch.stack([confidence / 2, confidence, confidence / 4])
    return ViewConfidence(confidence, torch.ones_like(confidence).long(), EMPTY_SURFACE, per_view)


def test_dense_cells_are_divided_if_they_or_a_neighbor_are_sure():
    trainer = make_trainer("subdivide", **FREE_POINTS)
    has_density = fill_ball(trainer, 0.6)
    old_points = trainer.points.positions
    is_confident = old_points[:, 0] > 0.25
    next_points = refine_points(
        trainer, make_view_confidence(is_confident * 0.5 + 0.05), torch.Generator()
    )
    points = next_points.points
    assert points.abs().max() < 1
    # a cell has six neighbors one spacing away; only x tells who is sure
    spacing = trainer.spacing
    assert next_points.spacing == spacing / 2
    expected = cell_indices(
        old_points[has_density & (old_points[:, 0] > 0.25 - 1.01 * spacing)], RES
    )
    actual = torch.unique(cell_indices(points, RES), dim=0)
    assert torch.equal(actual, torch.unique(expected, dim=0))
    assert len(points) == 8 * len(expected)


@pytest.mark.parametrize("target", ["density", "visible_density"])
def test_samples_join_the_dense_points(target):
    trainer = make_trainer(
        "inverse_transform", **FREE_POINTS, readings={"sampling_density": target}
    )
    has_density = fill_ball(trainer, 0.6)
    old_points = trainer.points.positions
    view_confidence = make_view_confidence((old_points[:, 2] > 0).float())
    next_points = refine_points(trainer, view_confidence, torch.Generator().manual_seed(0))
    points = next_points.points
    count = int(has_density.sum())
    assert torch.equal(points[:count], old_points[has_density])
    new_points = points[count:]
    assert len(new_points) == 1500
    assert new_points.abs().max() < 1
    allowed = cell_indices(
        old_points[has_density & ((old_points[:, 2] > 0) | (target == "density"))], RES
    )
    occupied = {tuple(cell) for cell in cell_indices(new_points, RES).tolist()}
    assert occupied <= {tuple(cell) for cell in allowed.tolist()}
    assert len(occupied) > 0.9 * len(allowed)
    # as far apart as so many points on a grid that fills the cells, at most half as far as before
    mean_spacing = (len(allowed) / 1500) ** (1 / 3) * trainer.spacing
    assert next_points.spacing == pytest.approx(min(mean_spacing, trainer.spacing / 2), rel=0.1)


@pytest.mark.parametrize("refine", ["subdivide", "inverse_transform"])
@pytest.mark.parametrize("kind", [FREE_POINTS, WITH_RESIDUAL], ids=["free", "both"])
def test_points_start_with_the_residuals_of_the_nearest(refine, kind):
    trainer = make_trainer(refine, **kind, density_bias=1.0)
    fill_ball(trainer, 0.6)
    view_confidence = make_view_confidence(torch.ones(len(trainer.points)))
    next_points = refine_points(trainer, view_confidence, torch.Generator().manual_seed(0))
    points, (raw, rgb) = next_points.points, next_points.residuals
    assert not raw.requires_grad
    assert not rgb.requires_grad
    old_points = trainer.points.positions
    distances = (points[:, None] - old_points).norm(dim=2)
    same = (raw[:, None] == trainer.field.raw) & (rgb[:, None] == trainer.field.rgb).all(dim=2)
    source_distances = distances.where(same, torch.inf).min(dim=1).values
    torch.testing.assert_close(source_distances, distances.min(dim=1).values, rtol=0, atol=1e-6)


def test_without_residuals_nothing_is_taken_over():
    trainer = make_trainer("inverse_transform", density_bias=1.0)
    view_confidence = make_view_confidence(torch.ones(len(trainer.points)))
    assert (
        refine_points(trainer, view_confidence, torch.Generator().manual_seed(0)).residuals is None
    )


def test_where_no_view_is_sure_of_anything_there_is_no_next_level():
    trainer = make_trainer("subdivide", **FREE_POINTS)
    no_confidence = make_view_confidence(torch.zeros(len(trainer.points)))
    with pytest.raises(ReconstructionFailed, match=r"after level 0 no view .* confidence of 0\.1"):
        refine_points(trainer, no_confidence, torch.Generator())


def test_the_warm_up_is_divided_into_the_first_grid_whatever_follows():
    trainer = make_trainer("inverse_transform", WARM_UP, **FREE_POINTS, warm_up={"steps": 5})
    fill_ball(trainer, 2.0)
    next_points = refine_points(
        trainer, make_view_confidence(torch.ones(len(trainer.points))), torch.Generator()
    )
    assert next_points.spacing == grid_spacing(RES, 0)
    first = cell_indices(initial_grid(next_points.spacing, CPU), RES)
    assert set(map(tuple, first.tolist())) <= set(
        map(tuple, cell_indices(next_points.points, RES).tolist())
    )


@pytest.mark.parametrize("refine", ["subdivide", "inverse_transform"])
def test_points_are_trusted_as_the_nearest_old_one_was(refine):
    trainer = make_trainer(refine, **FREE_POINTS, density_bias=1.0)
    fill_ball(trainer, 0.6)
    view_confidence = make_view_confidence(
        torch.rand(len(trainer.points), generator=torch.Generator().manual_seed(3))
    )
    next_points = refine_points(trainer, view_confidence, torch.Generator().manual_seed(0))
    indices = nearest_indices(trainer.points.positions, next_points.points)
    assert torch.equal(next_points.view_weights, view_confidence.per_view[:, indices])


@given(st.integers(0, 2**32 - 1))
def test_nearest_is_what_distances_say(seed):
    generator = torch.Generator().manual_seed(seed)
    points, queries = (torch.rand(count, 3, generator=generator) for count in (30, 50))
    distances = (queries[:, None] - points).double().norm(dim=2)
    actual = distances.gather(1, nearest_indices(points, queries)[:, None])[:, 0]
    torch.testing.assert_close(actual, distances.min(dim=1).values, rtol=0, atol=1e-7)
