"""The surface inside the hull: its constraint, its schedule, and pits that are filled."""

from dataclasses import replace
from itertools import product

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from industnerf.methods.industnerf.relief import FARTHEST, Relief, beside_on_grid, without_pits
from tests.methods.industnerf.scenes import settings

WAYS = replace(
    settings("industnerf_plus").relief,
    rate=0.1,
    back=0.5,
    back_in_doubt=0.7,
    back_within=1.0,
    fill_every=5,
    fill_from=0.5,
)
SIDE = 7
GRID = torch.tensor(list(product(range(SIDE), repeat=3))).float() * 0.1 - 0.3
BESIDE = beside_on_grid(GRID, 0.1)
CARVED = arrays("float32", SIDE**3, elements=st.floats(0, 8, width=32))


def number(*index: int) -> int:
    i, j, k = index
    return (i * SIDE + j) * SIDE + k


def test_beside_each_point_are_those_one_spacing_away():
    apart = torch.cdist(GRID, GRID)
    for point, found in enumerate(BESIDE):
        near = ((apart[point] > 0.05) & (apart[point] < 0.12)).nonzero()[:, 0]
        assert sorted(found[found >= 0].tolist()) == near.tolist()


def test_of_two_that_face_each_other_one_lies_before_and_one_behind():
    middle = BESIDE[number(3, 3, 3)]
    torch.testing.assert_close(GRID[middle[0::2]] - GRID[middle[1::2]], 0.2 * torch.eye(3))


def test_a_hole_of_one_point_is_filled_and_a_slot_of_one_point_stays():
    hull = torch.full((SIDE**3,), -2.0)
    hole, slot = hull.clone(), hull.clone()
    hole[[number(3, 3, k) for k in range(SIDE)]] = 1.0
    slot[[number(3, j, k) for j in range(SIDE) for k in range(SIDE)]] = 1.0
    assert torch.equal(without_pits(hole, hull, BESIDE), hull)
    assert torch.equal(without_pits(slot, hull, BESIDE), slot)


@given(CARVED)
def test_filling_never_carves(carved):
    hull = torch.linspace(-3, 2, SIDE**3)
    before = hull + torch.from_numpy(carved)
    after = without_pits(before, hull, BESIDE)
    assert (after <= before).all()
    assert (after >= hull - 1e-5).all()


@pytest.mark.parametrize(("believed", "left"), [(True, 3.0), (False, 2.6)])
def test_where_the_photographs_are_not_believed_more_falls_back(believed, left):
    hull, carved = torch.zeros(SIDE**3), torch.full((SIDE**3,), 4.0)
    Relief(hull, BESIDE, WAYS, believed=believed).fall_back(carved, 2.0)
    assert carved.unique().item() == pytest.approx(left)


def test_points_deeper_than_the_hull_stay_as_they_are():
    hull = torch.full((SIDE**3,), -1.0)
    assert torch.equal(without_pits(hull - 1, hull, BESIDE), hull - 1)


@given(CARVED, st.integers(1, 100))
def test_what_is_outside_the_hull_stays_outside(moved, taken):
    hull = torch.linspace(-3, 2, SIDE**3)
    distance = torch.from_numpy(4 - moved)
    Relief(hull, BESIDE, WAYS).settle(distance, taken, 100)
    assert (distance >= torch.where(hull > 0, hull, 3 * hull) - 1e-6).all()
    assert distance.abs().max() <= FARTHEST


@pytest.mark.parametrize(("taken", "filled"), [(45, False), (50, True), (51, False), (100, True)])
def test_pits_are_filled_now_and_then_from_half_time_on(taken, filled):
    hull = torch.full((SIDE**3,), -2.0)
    distance = hull.clone()
    distance[number(3, 3, 3)] = 1.0
    Relief(hull, BESIDE, WAYS).settle(distance, taken, 100)
    assert torch.equal(distance, hull) == filled


def test_pits_of_the_last_step_are_filled_whatever_its_number():
    hull = torch.full((SIDE**3,), -2.0)
    distance = hull.clone()
    distance[number(3, 3, 3)] = 1.0
    Relief(hull, BESIDE, replace(WAYS, fill_every=1000)).settle(distance, 7, 7)
    assert torch.equal(distance, hull)


def test_pits_are_kept_where_none_are_to_be_filled():
    distance = torch.full((SIDE**3,), -2.0)
    distance[number(3, 3, 3)] = 1.0
    pits = distance.clone()
    Relief(torch.full((SIDE**3,), -2.0), BESIDE, replace(WAYS, fill_every=0)).settle(distance, 7, 7)
    assert torch.equal(distance, pits)


def test_steps_are_as_long_as_the_surface_is_soft():
    relief = Relief(torch.zeros(SIDE**3), BESIDE, WAYS)
    assert [relief.rate(beta) for beta in (2.0, 0.5)] == pytest.approx([0.2, 0.05])


@given(CARVED, CARVED)
def test_it_starts_where_it_is_told_to_and_nowhere_deeper_than_the_hull(carved, raised):
    hull = torch.linspace(-3, 2, SIDE**3)
    start = hull + torch.from_numpy(carved) - torch.from_numpy(raised)
    begun = Relief(hull, BESIDE, WAYS, start).within(None)
    assert torch.equal(begun, torch.maximum(start.clamp(-WAYS.start.deepest, FARTHEST), hull))


@given(CARVED, CARVED, st.floats(0, 2))
def test_what_was_carved_falls_back_by_its_share_of_a_step_and_no_farther_than_the_start(
    carved, moved, rate
):
    hull = torch.linspace(-3, 2, SIDE**3)
    relief = Relief(hull, BESIDE, WAYS, hull + torch.from_numpy(carved))
    start = relief.within(None)
    before = start + torch.from_numpy(moved) - 4
    after = before.clone()
    relief.fall_back(after, rate)
    falls = (before > start) & (hull >= -WAYS.back_within)
    assert torch.equal(after[~falls], before[~falls])
    expected = torch.maximum(before - WAYS.back * rate, start)
    assert torch.equal(after[falls], expected[falls])


def test_what_is_carved_deep_inside_the_hull_stays_carved():
    hull = torch.full((SIDE**3,), -0.5)
    deep = GRID[:, 0] > 0
    hull[deep] = -1.5  # WAYS.back_within is 1
    distance = torch.full((SIDE**3,), 1.0)
    Relief(hull, BESIDE, WAYS).fall_back(distance, 2.0)
    assert (distance[deep] == 1.0).all()
    assert (distance[~deep] == 0.0).all()  # half of a step of 2
