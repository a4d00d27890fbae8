"""The next level's points: near what is sure, inside the box, with what they take over."""

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from industnerf.errors import ReconstructionFailed
from industnerf.methods.industnerf import witnesses  # a class called Test... would be collected
from industnerf.methods.industnerf.field import Field
from industnerf.methods.industnerf.levels import WARM_UP, Layer, cells_of, grid, spacing_of
from industnerf.methods.industnerf.refine import nearest, refined
from industnerf.methods.industnerf.training import Training
from tests.methods.industnerf.scenes import BOTH, CPU, FREE, ball, scene, settings

NONE = witnesses.Surface(
    torch.zeros(0, 3), torch.zeros(0, 3), torch.zeros(0), torch.zeros(0).long()
)
RES = 10
TWO = [{}, {"points": 1500}]


def a_training(refine: str, level: int = 0, **changes) -> Training:
    ways = settings("industnerf", refine=refine, grid_res=RES, levels=TWO, **changes)
    seen = scene(ball(18.0), 3, 24)
    field = Field(seen, ways)
    layer = Layer(grid(spacing_of(RES, level), CPU), spacing_of(RES, level))
    return Training(seen, field, layer, level, ways, torch.Generator())


def solid_inside(training: Training, radius: float) -> torch.Tensor:
    """Makes points dense within `radius`, and each residual unlike any other."""
    dense = training.points.positions.norm(dim=1) < radius
    count = len(dense)
    with torch.no_grad():
        training.field.raw.copy_(torch.linspace(0, 1, count).where(dense, -7.0))
        training.field.rgb.copy_(torch.rand(count, 3, generator=torch.Generator().manual_seed(0)))
    return dense


def told_of(confidence: torch.Tensor) -> witnesses.Testimony:
    """Three views, of which the second is as sure as this."""
    each = torch.stack([confidence / 2, confidence, confidence / 4])
    return witnesses.Testimony(confidence, torch.ones_like(confidence).long(), NONE, each)


def test_dense_cells_are_divided_if_they_or_a_neighbour_are_sure():
    training = a_training("divided", **FREE)
    dense = solid_inside(training, 0.6)
    old = training.points.positions
    sure = old[:, 0] > 0.25
    layer = refined(training, told_of(sure * 0.5 + 0.05), torch.Generator())
    points = layer.points
    assert points.abs().max() < 1
    # a cell has six neighbours one spacing away; only x tells who is sure
    spacing = training.spacing
    assert layer.spacing == spacing / 2
    expected = cells_of(old[dense & (old[:, 0] > 0.25 - 1.01 * spacing)], RES)
    found = torch.unique(cells_of(points, RES), dim=0)
    assert torch.equal(found, torch.unique(expected, dim=0))
    assert len(points) == 8 * len(expected)


@pytest.mark.parametrize("target", ["sigma", "visible"])
def test_samples_join_the_dense_points(target):
    training = a_training("sampled", **FREE, readings={"target": target})
    dense = solid_inside(training, 0.6)
    old = training.points.positions
    told = told_of((old[:, 2] > 0).float())
    layer = refined(training, told, torch.Generator().manual_seed(0))
    points = layer.points
    count = int(dense.sum())
    assert torch.equal(points[:count], old[dense])
    fresh = points[count:]
    assert len(fresh) == 1500
    assert fresh.abs().max() < 1
    allowed = cells_of(old[dense & ((old[:, 2] > 0) | (target == "sigma"))], RES)
    held = {tuple(cell) for cell in cells_of(fresh, RES).tolist()}
    assert held <= {tuple(cell) for cell in allowed.tolist()}
    assert len(held) > 0.9 * len(allowed)
    # as far apart as so many points on a grid that fills the cells, at most half as far as before
    apart = (len(allowed) / 1500) ** (1 / 3) * training.spacing
    assert layer.spacing == pytest.approx(min(apart, training.spacing / 2), rel=0.1)


@pytest.mark.parametrize("refine", ["divided", "sampled"])
@pytest.mark.parametrize("kind", [FREE, BOTH], ids=["free", "both"])
def test_points_start_with_the_residuals_of_the_nearest(refine, kind):
    training = a_training(refine, **kind, initial=1.0)
    solid_inside(training, 0.6)
    told = told_of(torch.ones(len(training.points)))
    layer = refined(training, told, torch.Generator().manual_seed(0))
    points, (raw, rgb) = layer.points, layer.residuals
    assert not raw.requires_grad
    assert not rgb.requires_grad
    old = training.points.positions
    apart = (points[:, None] - old).norm(dim=2)
    same = (raw[:, None] == training.field.raw) & (rgb[:, None] == training.field.rgb).all(dim=2)
    taken = apart.where(same, torch.inf).min(dim=1).values
    torch.testing.assert_close(taken, apart.min(dim=1).values, rtol=0, atol=1e-6)


def test_without_residuals_nothing_is_taken_over():
    training = a_training("sampled", initial=1.0)
    told = told_of(torch.ones(len(training.points)))
    assert refined(training, told, torch.Generator().manual_seed(0)).residuals is None


def test_where_no_view_is_sure_of_anything_there_is_no_next_level():
    training = a_training("divided", **FREE)
    nothing = told_of(torch.zeros(len(training.points)))
    with pytest.raises(ReconstructionFailed, match=r"after level 0 no view is surer than 0\.1"):
        refined(training, nothing, torch.Generator())


def test_the_warm_up_is_divided_into_the_first_grid_whatever_follows():
    training = a_training("sampled", WARM_UP, **FREE, warm_up={"steps": 5})
    solid_inside(training, 2.0)
    layer = refined(training, told_of(torch.ones(len(training.points))), torch.Generator())
    assert layer.spacing == spacing_of(RES, 0)
    first = cells_of(grid(layer.spacing, CPU), RES)
    assert set(map(tuple, first.tolist())) <= set(map(tuple, cells_of(layer.points, RES).tolist()))


@pytest.mark.parametrize("refine", ["divided", "sampled"])
def test_points_are_trusted_as_the_nearest_old_one_was(refine):
    training = a_training(refine, **FREE, initial=1.0)
    solid_inside(training, 0.6)
    told = told_of(torch.rand(len(training.points), generator=torch.Generator().manual_seed(3)))
    layer = refined(training, told, torch.Generator().manual_seed(0))
    which = nearest(training.points.positions, layer.points)
    assert torch.equal(layer.trust, told.of_views[:, which])


@given(st.integers(0, 2**32 - 1))
def test_nearest_is_what_distances_say(seed):
    generator = torch.Generator().manual_seed(seed)
    points, queries = (torch.rand(count, 3, generator=generator) for count in (30, 50))
    apart = (queries[:, None] - points).double().norm(dim=2)
    found = apart.gather(1, nearest(points, queries)[:, None])[:, 0]
    torch.testing.assert_close(found, apart.min(dim=1).values, rtol=0, atol=1e-7)
