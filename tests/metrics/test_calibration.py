"""Confidence against error, where both curves are known."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import spearmanr

from industnerf.metrics.calibration import (
    ause,
    random_ause,
    sparsification,
    sparsification_at,
    spearman,
)

SEEDS = st.integers(0, 1000)
MANY = 2000
ERROR = (np.arange(MANY) + 0.5) / MANY  # evenly in [0, 1]


def random_values(seed: int, count: int = 40) -> tuple[np.ndarray, np.ndarray]:
    """Errors, and confidences with ties."""
    rng = np.random.default_rng(seed)
    return rng.random(count), rng.integers(0, 8, count).astype(float)


@given(SEEDS)
def test_the_rank_correlation_is_scipys(seed):
    a, b = random_values(seed)
    assert spearman(a, b) == pytest.approx(spearmanr(a, b).statistic, abs=1e-12)


def test_a_rising_function_changes_no_rank_and_a_falling_one_all():
    assert spearman(ERROR, np.exp(ERROR)) == pytest.approx(1, abs=1e-12)
    assert spearman(ERROR, 1 - ERROR**3) == pytest.approx(-1, abs=1e-12)


def test_confidence_that_is_the_same_everywhere_says_nothing():
    same = np.full(MANY, 0.7)
    assert spearman(ERROR, same) == 0
    assert ause(ERROR, same) == pytest.approx(random_ause(ERROR), abs=1e-12)


def test_even_errors_have_the_curves_of_a_line():
    """Without the share f of the worst, the mean is 1 - f of the whole; without the best, 1 + f."""
    share = np.arange(MANY) / MANY
    np.testing.assert_allclose(sparsification(ERROR, -ERROR), 1 - share, rtol=0, atol=1e-12)
    np.testing.assert_allclose(sparsification(ERROR, ERROR), 1 + share, rtol=0, atol=1e-12)
    coarse = np.array([0.0, 0.1, 0.9])
    np.testing.assert_allclose(
        sparsification_at(ERROR, -ERROR, coarse), 1 - coarse, rtol=0, atol=1e-12
    )
    # a sum of steps against an integral: both lines are off by half a step
    assert ause(ERROR, -ERROR) == 0
    assert random_ause(ERROR) == pytest.approx(1 / 2, abs=1 / MANY)
    assert ause(ERROR, ERROR) == pytest.approx(1, abs=1 / MANY)


def test_where_there_is_no_error_none_is_left():
    np.testing.assert_array_equal(
        sparsification_at(np.zeros(5), np.arange(5.0), np.array([0.1, 0.5])), 0
    )


@given(SEEDS)
def test_no_order_is_better_than_the_true_one(seed):
    error, confidence = random_values(seed)
    assert ause(error, -error) == 0
    assert ause(error, confidence) >= -1e-12
    assert random_ause(error) >= -1e-12


@given(SEEDS, st.floats(0.1, 100))
def test_neither_the_unit_of_the_error_nor_the_scale_of_the_confidence_matters(seed, factor):
    error, confidence = random_values(seed)
    assert ause(factor * error, confidence**3) == pytest.approx(ause(error, confidence), abs=1e-9)


def test_ties_count_as_the_mean_over_every_order_of_them():
    error, confidence = np.array([0.1, 0.5, 0.2, 0.9, 0.4]), np.array([1, 1, 1, 2, 2.0])
    orders = [
        ause(error, np.array([*first, *(4 + np.array(last))], float))
        for first in itertools.permutations(range(3))
        for last in itertools.permutations(range(2))
    ]
    assert ause(error, confidence) == pytest.approx(np.mean(orders), abs=1e-12)


def test_without_any_error_there_is_no_area():
    assert ause(np.zeros(5), np.arange(5.0)) == 0
    assert random_ause(np.zeros(5)) == 0
