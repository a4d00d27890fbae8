"""A change on trial is undone to the byte, unless the pictures are for it and it is to stay."""

import numpy as np
import pytest

from industnerf.methods.industnerf_plus.shaded_surface import PinholeRays
from industnerf.methods.industnerf_plus.trials import Change, Trials, every_nth, in_box

from .plugged_block import BLOCK, POCKET, VIEWS, photographs, surface_of

TRUE = np.maximum(BLOCK, -POCKET)


@pytest.fixture
def trials() -> Trials:
    surface = surface_of(BLOCK)
    return Trials(surface, PinholeRays(VIEWS, np.zeros(3), 1.0, surface.grid), photographs(TRUE))


def change_of(trials: Trials, recess: np.ndarray) -> Change:
    nodes = np.argwhere(BLOCK < 2.5)
    before = trials.distance[tuple(nodes.T)]
    depth = -recess[tuple(nodes.T)].astype(np.float32)
    change = Change.of(nodes, before, np.maximum(before, depth))
    assert change is not None
    return change


def everything(trials: Trials) -> np.ndarray:
    return np.arange(len(trials.pixels))


def test_what_is_not_kept_leaves_no_trace(trials):
    is_near = np.abs(trials.distance) < 3  # rays need no other gradients
    gradient = trials.surface.gradient
    before = [trials.distance.copy(), gradient.numpy()[is_near], trials.points.copy()]
    verdict = trials.attempt(change_of(trials, POCKET), everything(trials), 0.9, keep=False)
    assert verdict is not None
    assert verdict.gain > 0
    after = [trials.distance, gradient.numpy()[is_near], trials.points]
    for old, new in zip(before, after, strict=True):
        np.testing.assert_array_equal(old, new)
    np.testing.assert_array_equal(trials.surface.distance.numpy(), trials.distance)


def test_what_is_kept_costs_less_from_then_on(trials):
    change = change_of(trials, POCKET)
    kept = trials.attempt(change, everything(trials), 0.9, keep=True)
    fresh = Trials(trials.surface, trials.rays, trials.pictures)
    np.testing.assert_allclose(fresh.points, trials.points, atol=1e-4)
    back = Change(change.nodes, change.after, change.before)
    undone = fresh.attempt(back, everything(trials), 1e6, keep=False)
    assert undone.before == pytest.approx(kept.after)
    assert undone.after == pytest.approx(kept.before)


def test_a_wrong_change_is_refused_even_to_be_kept(trials):
    before = trials.distance.copy()
    wrong = np.linalg.norm(np.argwhere(np.ones_like(BLOCK)) - [44, 28, 28], axis=1)
    wrong = wrong.reshape(BLOCK.shape) - 6
    assert trials.attempt(change_of(trials, wrong), everything(trials), 0.9, keep=True) is None
    np.testing.assert_array_equal(trials.distance, before)


def test_a_change_of_few_nodes_is_none():
    nodes = np.zeros((5, 3), np.int64)
    low, high = np.full(5, -1, np.float32), np.full(5, 1, np.float32)
    assert Change.of(nodes, low, high) is None


def test_in_box_is_what_a_comparison_of_all_axes_is():
    rng = np.random.default_rng(0)
    points = rng.uniform(0, 10, (500, 3)).astype(np.float32)
    lo, hi = np.array([3, 2, 4]), np.array([7, 8, 9])
    expected = np.flatnonzero(((points > lo - 1) & (points < hi)).all(axis=1))
    np.testing.assert_array_equal(in_box(points, lo, hi), expected)


def test_every_nth_leaves_at_most_as_many():
    assert len(every_nth(np.arange(1001), 100)) <= 100
    np.testing.assert_array_equal(every_nth(np.arange(7), 100), np.arange(7))
