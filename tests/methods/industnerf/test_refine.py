"""The next level's points: near what is sure, inside the box, with what they take over."""

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from industnerf.methods.industnerf import witnesses  # a class called Test... would be collected
from industnerf.methods.industnerf.field import Field
from industnerf.methods.industnerf.levels import cells_of, grid, spacing_of
from industnerf.methods.industnerf.refine import nearest, refined
from industnerf.methods.industnerf.training import Training
from tests.methods.industnerf.scenes import BOTH, CPU, FREE, ball, scene, settings

NONE = witnesses.Surface(
    torch.zeros(0, 3), torch.zeros(0, 3), torch.zeros(0), torch.zeros(0).long()
)
RES = 10
TWO = [{}, {"points": 1500}]


def a_training(refine: str, **changes) -> Training:
    ways = settings("industnerf", refine=refine, grid_res=RES, levels=TWO, **changes)
    seen = scene(ball(18.0), 3, 24)
    field = Field(seen, ways)
    points = grid(RES, CPU)
    return Training(seen, field, points, spacing_of(RES, 0), 0, ways, torch.Generator(), None)


def solid_inside(training: Training, radius: float) -> torch.Tensor:
    """Makes points dense within `radius`, and each residual unlike any other."""
    dense = training.points.positions.norm(dim=1) < radius
    count = len(dense)
    with torch.no_grad():
        training.field.raw.copy_(torch.linspace(0, 1, count).where(dense, -7.0))
        training.field.rgb.copy_(torch.rand(count, 3, generator=torch.Generator().manual_seed(0)))
    return dense


def told_of(confidence: torch.Tensor) -> witnesses.Testimony:
    return witnesses.Testimony(confidence, torch.zeros_like(confidence).long(), NONE)


def test_dense_cells_are_divided_if_they_or_a_neighbour_are_sure():
    training = a_training("divided", **FREE, least_confidence=0.5)
    dense = solid_inside(training, 0.6)
    old = training.points.positions
    sure = old[:, 0] > 0.25
    points, _ = refined(training, told_of(sure * 0.5 + 0.1), torch.Generator())
    assert points.abs().max() < 1
    # a cell has six neighbours one spacing away; only x tells who is sure
    spacing = training.spacing
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
    points, _ = refined(training, told, torch.Generator().manual_seed(0))
    count = int(dense.sum())
    assert torch.equal(points[:count], old[dense])
    fresh = points[count:]
    assert len(fresh) == 1500
    assert fresh.abs().max() < 1
    allowed = cells_of(old[dense & ((old[:, 2] > 0) | (target == "sigma"))], RES)
    held = {tuple(cell) for cell in cells_of(fresh, RES).tolist()}
    assert held <= {tuple(cell) for cell in allowed.tolist()}
    assert len(held) > 0.9 * len(allowed)


@pytest.mark.parametrize("refine", ["divided", "sampled"])
@pytest.mark.parametrize("kind", [FREE, BOTH], ids=["free", "both"])
def test_points_start_with_the_residuals_of_the_nearest(refine, kind):
    training = a_training(refine, **kind, initial=1.0)
    solid_inside(training, 0.6)
    told = told_of(torch.ones(len(training.points)))
    points, (raw, rgb) = refined(training, told, torch.Generator().manual_seed(0))
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
    assert refined(training, told, torch.Generator().manual_seed(0))[1] is None


def test_where_nothing_is_sure_nothing_is_divided():
    training = a_training("divided", **FREE)
    points, start = refined(training, told_of(torch.zeros(len(training.points))), torch.Generator())
    assert len(points) == len(start[0]) == len(start[1]) == 0


@given(st.integers(0, 2**32 - 1))
def test_nearest_is_what_distances_say(seed):
    generator = torch.Generator().manual_seed(seed)
    points, queries = (torch.rand(count, 3, generator=generator) for count in (30, 50))
    apart = (queries[:, None] - points).double().norm(dim=2)
    found = apart.gather(1, nearest(points, queries)[:, None])[:, 0]
    torch.testing.assert_close(found, apart.min(dim=1).values, rtol=0, atol=1e-7)
