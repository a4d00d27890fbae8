"""The next level of a surface: everything beside it, linear between the points, cut by the hull."""

import pytest
import torch

from industnerf.methods.industnerf.beside import (
    REACH,
    beside_surface,
    dense,
    finer_surface,
    linear,
)
from industnerf.methods.industnerf.levels import cells_of, grid, spacing_of
from industnerf.methods.industnerf.relief import Relief
from tests.methods.industnerf.scenes import CPU, settings

RES = 16
SPACING = spacing_of(RES, 0)
POINTS = grid(SPACING, CPU)
AXIS = -1 + SPACING * (torch.arange(RES) + 0.5)
RADIUS = 0.55


def ball(points: torch.Tensor) -> torch.Tensor:
    return points.norm(dim=1) - RADIUS


def coloured(points: torch.Tensor) -> torch.Tensor:
    """A colour for every cell of the first grid."""
    return cells_of(points, RES).float() / RES


def test_what_is_linear_stays_as_it_is_and_beyond_the_last_centre_as_it_is_there():
    slopes = torch.tensor([0.3, -1.2, 0.7])
    values = torch.cartesian_prod(AXIS, AXIS, AXIS) @ slopes + 0.2
    points = 2 * torch.rand(500, 3, generator=torch.Generator().manual_seed(0)) - 1
    last = 1 - SPACING / 2
    expected = points.clamp(-last, last) @ slopes + 0.2
    found = linear(values.reshape(RES, RES, RES), points)
    assert torch.allclose(found, expected, atol=1e-5)  # sums of float32 near 1


def test_cells_beside_a_surface_see_the_other_sign_within_reach():
    distance = AXIS[:, None, None].expand(RES, RES, RES)  # < 0 in the first half of the rows
    rows = beside_surface(distance, REACH).all(dim=2).all(dim=1)
    half = RES // 2
    assert rows.nonzero()[:, 0].tolist() == list(range(half - REACH, half + REACH))


def test_no_surface_no_cells():
    assert not beside_surface(torch.ones(RES, RES, RES), REACH).any()


def test_a_cell_without_a_point_has_the_distance_of_the_nearest():
    shell = POINTS[ball(POINTS).abs() < 2.5 * SPACING]  # hollow, and nothing outside
    signs = dense(shell, ball(shell), RES) < 0
    everywhere = torch.cartesian_prod(AXIS, AXIS, AXIS)
    assert torch.equal(signs.flatten(), ball(everywhere) < 0)


def test_a_ball_keeps_its_surface_level_after_level():
    points, distance, spacing = POINTS, ball(POINTS), SPACING
    for _ in range(3):
        layer = finer_surface(points, distance, coloured(points), spacing)
        points, spacing = layer.points, layer.spacing
        distance, rgb = layer.residuals
        near = ball(points).abs() < spacing
        # |x| bends by 1 / |x| along two axes, of which a line between two points misses
        # h^2 / (8 |x|) each; every level adds a quarter of the last one's error
        bend = SPACING**2 / (4 * (RADIUS - SPACING))
        assert (distance - ball(points))[near].abs().max() < 4 / 3 * bend
        # REACH cells that were divided, and one more for where in them; across their corners
        assert ball(points).abs().max() < (REACH + 1) * 2 * spacing * 3**0.5
        assert torch.equal(rgb, coloured(points))
    assert spacing == SPACING / 8


def test_all_space_beside_the_surface_has_points():
    fine = finer_surface(POINTS, ball(POINTS), coloured(POINTS), SPACING)
    whole = torch.cartesian_prod(*[torch.arange(2 * RES)] * 3)
    centres = -1 + fine.spacing * (whole + 0.5)
    near = whole[ball(centres).abs() < SPACING]
    have = {tuple(cell) for cell in cells_of(fine.points, 2 * RES).tolist()}
    assert {tuple(cell) for cell in near.tolist()} <= have
    assert len(have) == len(fine.points)


@pytest.mark.parametrize("shift", [-0.4, 0.0, 0.4])
def test_a_relief_starts_at_the_hull_or_within_it(shift):
    hull = torch.linspace(-2, 2, 9)
    ways = settings("industnerf_plus").relief
    relief = Relief(hull, torch.full((9, 6), -1), ways)
    assert torch.equal(relief.within(None), hull)
    within = relief.within(hull + shift)
    assert torch.equal(within, hull + max(shift, 0.0))
