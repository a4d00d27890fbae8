"""The surface inside the hull: its constraint, its schedule, and pits that are filled."""

from dataclasses import replace
from itertools import product

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from industnerf.methods.industnerf_plus.sdf_constraints import (
    MAX_ABS_SDF,
    SdfConstraints,
    grid_neighbors,
    median_filter,
)
from tests.methods.industnerf.synthetic_scenes import settings

SETTINGS = replace(
    settings("industnerf_plus").sdf,
    lr=0.1,
    relax_rate=0.5,
    relax_rate_low_confidence=0.7,
    relax_max_depth=1.0,
    median_filter_interval=5,
    median_filter_start=0.5,
)
SIDE = 7
GRID = torch.tensor(list(product(range(SIDE), repeat=3))).float() * 0.1 - 0.3
NEIGHBORS = grid_neighbors(GRID, 0.1)
CARVED = arrays("float32", SIDE**3, elements=st.floats(0, 8, width=32))


def flat_index(*index: int) -> int:
    i, j, k = index
    return (i * SIDE + j) * SIDE + k


def test_beside_each_point_are_those_one_spacing_away():
    distances = torch.cdist(GRID, GRID)
    for point, actual in enumerate(NEIGHBORS):
        expected = ((distances[point] > 0.05) & (distances[point] < 0.12)).nonzero()[:, 0]
        assert sorted(actual[actual >= 0].tolist()) == expected.tolist()


def test_of_two_that_face_each_other_one_lies_before_and_one_behind():
    middle = NEIGHBORS[flat_index(3, 3, 3)]
    torch.testing.assert_close(GRID[middle[0::2]] - GRID[middle[1::2]], 0.2 * torch.eye(3))


def test_a_hole_of_one_point_is_filled_and_a_slot_of_one_point_stays():
    hull = torch.full((SIDE**3,), -2.0)
    hole, slot = hull.clone(), hull.clone()
    hole[[flat_index(3, 3, k) for k in range(SIDE)]] = 1.0
    slot[[flat_index(3, j, k) for j in range(SIDE) for k in range(SIDE)]] = 1.0
    assert torch.equal(median_filter(hole, hull, NEIGHBORS), hull)
    assert torch.equal(median_filter(slot, hull, NEIGHBORS), slot)


@given(CARVED)
def test_filling_never_carves(carved):
    hull = torch.linspace(-3, 2, SIDE**3)
    before = hull + torch.from_numpy(carved)
    after = median_filter(before, hull, NEIGHBORS)
    assert (after <= before).all()
    assert (after >= hull - 1e-5).all()


@pytest.mark.parametrize(("is_reliable", "expected"), [(True, 3.0), (False, 2.6)])
def test_where_the_photographs_are_not_believed_more_falls_back(is_reliable, expected):
    hull, carved = torch.zeros(SIDE**3), torch.full((SIDE**3,), 4.0)
    SdfConstraints(hull, NEIGHBORS, SETTINGS, is_reliable=is_reliable).relax_to_initial(carved, 2.0)
    assert carved.unique().item() == pytest.approx(expected)


def test_points_deeper_than_the_hull_stay_as_they_are():
    hull = torch.full((SIDE**3,), -1.0)
    assert torch.equal(median_filter(hull - 1, hull, NEIGHBORS), hull - 1)


@given(CARVED, st.integers(1, 100))
def test_what_is_outside_the_hull_stays_outside(moved, steps_done):
    hull = torch.linspace(-3, 2, SIDE**3)
    distance = torch.from_numpy(4 - moved)
    SdfConstraints(hull, NEIGHBORS, SETTINGS).constrain(distance, steps_done, 100)
    assert (distance >= torch.where(hull > 0, hull, 3 * hull) - 1e-6).all()
    assert distance.abs().max() <= MAX_ABS_SDF


@pytest.mark.parametrize(
    ("steps_done", "filled"), [(45, False), (50, True), (51, False), (100, True)]
)
def test_pits_are_filled_now_and_then_from_half_time_on(steps_done, filled):
    hull = torch.full((SIDE**3,), -2.0)
    distance = hull.clone()
    distance[flat_index(3, 3, 3)] = 1.0
    SdfConstraints(hull, NEIGHBORS, SETTINGS).constrain(distance, steps_done, 100)
    assert torch.equal(distance, hull) == filled


def test_pits_of_the_last_step_are_filled_whatever_its_number():
    hull = torch.full((SIDE**3,), -2.0)
    distance = hull.clone()
    distance[flat_index(3, 3, 3)] = 1.0
    SdfConstraints(hull, NEIGHBORS, replace(SETTINGS, median_filter_interval=1000)).constrain(
        distance, 7, 7
    )
    assert torch.equal(distance, hull)


def test_pits_are_kept_where_none_are_to_be_filled():
    distance = torch.full((SIDE**3,), -2.0)
    distance[flat_index(3, 3, 3)] = 1.0
    pits = distance.clone()
    SdfConstraints(
        torch.full((SIDE**3,), -2.0), NEIGHBORS, replace(SETTINGS, median_filter_interval=0)
    ).constrain(distance, 7, 7)
    assert torch.equal(distance, pits)


def test_steps_are_as_long_as_the_surface_is_soft():
    constraints = SdfConstraints(torch.zeros(SIDE**3), NEIGHBORS, SETTINGS)
    assert [constraints.lr(beta) for beta in (2.0, 0.5)] == pytest.approx([0.2, 0.05])


@given(CARVED, CARVED)
def test_it_starts_where_it_is_told_to_and_nowhere_deeper_than_the_hull(carved, raised):
    hull = torch.linspace(-3, 2, SIDE**3)
    start = hull + torch.from_numpy(carved) - torch.from_numpy(raised)
    initial = SdfConstraints(hull, NEIGHBORS, SETTINGS, start).initial_raw(None)
    assert torch.equal(
        initial, torch.maximum(start.clamp(-SETTINGS.init.initial_max_depth, MAX_ABS_SDF), hull)
    )


@given(CARVED, CARVED, st.floats(0, 2))
def test_what_was_carved_falls_back_by_its_share_of_a_step_and_no_farther_than_the_start(
    carved, moved, rate
):
    hull = torch.linspace(-3, 2, SIDE**3)
    constraints = SdfConstraints(hull, NEIGHBORS, SETTINGS, hull + torch.from_numpy(carved))
    start = constraints.initial_raw(None)
    before = start + torch.from_numpy(moved) - 4
    after = before.clone()
    constraints.relax_to_initial(after, rate)
    is_relaxed = (before > start) & (hull >= -SETTINGS.relax_max_depth)
    assert torch.equal(after[~is_relaxed], before[~is_relaxed])
    expected = torch.maximum(before - SETTINGS.relax_rate * rate, start)
    assert torch.equal(after[is_relaxed], expected[is_relaxed])


def test_what_is_carved_deep_inside_the_hull_stays_carved():
    hull = torch.full((SIDE**3,), -0.5)
    deep = GRID[:, 0] > 0
    hull[deep] = -1.5  # WAYS.back_within is 1
    distance = torch.full((SIDE**3,), 1.0)
    SdfConstraints(hull, NEIGHBORS, SETTINGS).relax_to_initial(distance, 2.0)
    assert (distance[deep] == 1.0).all()
    assert (distance[~deep] == 0.0).all()  # half of a step of 2
