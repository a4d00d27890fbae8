"""The next level of a surface: everything beside it, linear between the points, cut by the hull."""

import pytest
import torch

from industnerf.methods.industnerf.point_levels import cell_indices, grid_spacing, initial_grid
from industnerf.methods.industnerf_plus.narrow_band import (
    BAND_CELLS,
    densify,
    narrow_band_mask,
    subdivide_narrow_band,
    trilinear,
)
from industnerf.methods.industnerf_plus.sdf_constraints import SdfConstraints
from tests.methods.industnerf.synthetic_scenes import CPU, settings

RES = 16
SPACING = grid_spacing(RES, 0)
POINTS = initial_grid(SPACING, CPU)
AXIS = -1 + SPACING * (torch.arange(RES) + 0.5)
RADIUS = 0.55


def ball(points: torch.Tensor) -> torch.Tensor:
    return points.norm(dim=1) - RADIUS


def colored(points: torch.Tensor) -> torch.Tensor:
    """A color for every cell of the first grid."""
    return cell_indices(points, RES).float() / RES


def test_what_is_linear_stays_as_it_is_and_beyond_the_last_center_as_it_is_there():
    slopes = torch.tensor([0.3, -1.2, 0.7])
    values = torch.cartesian_prod(AXIS, AXIS, AXIS) @ slopes + 0.2
    points = 2 * torch.rand(500, 3, generator=torch.Generator().manual_seed(0)) - 1
    last = 1 - SPACING / 2
    expected = points.clamp(-last, last) @ slopes + 0.2
    actual = trilinear(values.reshape(RES, RES, RES), points)
    assert torch.allclose(actual, expected, atol=1e-5)  # sums of float32 near 1


def test_cells_beside_a_surface_see_the_other_sign_within_reach():
    distance = AXIS[:, None, None].expand(RES, RES, RES)  # < 0 in the first half of the rows
    rows = narrow_band_mask(distance, BAND_CELLS).all(dim=2).all(dim=1)
    half = RES // 2
    assert rows.nonzero()[:, 0].tolist() == list(range(half - BAND_CELLS, half + BAND_CELLS))


def test_no_surface_no_cells():
    assert not narrow_band_mask(torch.ones(RES, RES, RES), BAND_CELLS).any()


def test_a_cell_without_a_point_has_the_distance_of_the_nearest():
    shell = POINTS[ball(POINTS).abs() < 2.5 * SPACING]  # hollow, and nothing outside
    signs = densify(shell, ball(shell), RES) < 0
    everywhere = torch.cartesian_prod(AXIS, AXIS, AXIS)
    assert torch.equal(signs.flatten(), ball(everywhere) < 0)


def test_a_ball_keeps_its_surface_level_after_level():
    points, distance, spacing = POINTS, ball(POINTS), SPACING
    for _ in range(3):
        layer = subdivide_narrow_band(points, distance, colored(points), spacing)
        points, spacing = layer.points, layer.spacing
        distance, rgb = layer.residuals
        near = ball(points).abs() < spacing
        # |x| bends by 1 / |x| along two axes, of which a line between two points misses
        # h^2 / (8 |x|) each; every level adds a quarter of the last one's error
        bend = SPACING**2 / (4 * (RADIUS - SPACING))
        assert (distance - ball(points))[near].abs().max() < 4 / 3 * bend
        # REACH cells that were divided, and one more for where in them; across their corners
        assert ball(points).abs().max() < (BAND_CELLS + 1) * 2 * spacing * 3**0.5
        assert torch.equal(rgb, colored(points))
    assert spacing == SPACING / 8


def test_all_space_beside_the_surface_has_points():
    level = subdivide_narrow_band(POINTS, ball(POINTS), colored(POINTS), SPACING)
    cells = torch.cartesian_prod(*[torch.arange(2 * RES)] * 3)
    centers = -1 + level.spacing * (cells + 0.5)
    near_surface = cells[ball(centers).abs() < SPACING]
    occupied = {tuple(cell) for cell in cell_indices(level.points, 2 * RES).tolist()}
    assert {tuple(cell) for cell in near_surface.tolist()} <= occupied
    assert len(occupied) == len(level.points)


@pytest.mark.parametrize("shift", [-0.4, 0.0, 0.4])
def test_a_relief_starts_at_the_hull_or_within_it(shift):
    hull = torch.linspace(-2, 2, 9)
    config = settings("industnerf_plus").sdf
    constraints = SdfConstraints(hull, torch.full((9, 6), -1), config)
    assert torch.equal(constraints.initial_raw(None), hull)
    initial = constraints.initial_raw(hull + shift)
    assert torch.equal(initial, hull + max(shift, 0.0))
