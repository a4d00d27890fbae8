"""Transport by squared distance: closed forms that its plan has and that of W1 has not."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from industnerf.errors import MetricError
from industnerf.metrics.emd import emd

SEEDS, SIZES = st.integers(0, 10**6), st.one_of(st.integers(1, 40), st.integers(370, 420))


def squared(a, b) -> float:
    return emd(a, b, squared=True).value


def cloud(n, seed=0):
    return np.random.default_rng(seed).normal(size=(n, 3))


@given(SEEDS, SIZES)
def test_a_shift_costs_its_square(seed, n):
    """The mean displacement is the shift, whatever the plan: its square bounds the mean square."""
    shift = np.array([0.3, 0.0, 0.4])
    assert squared(cloud(n, seed), cloud(n, seed) + shift) == pytest.approx(0.25, rel=1e-9)


@given(SEEDS, SIZES, SIZES)
def test_means_part_from_shapes(seed, n, m):
    """W2^2(X, Y) = |mean X - mean Y|^2 + W2^2 of both round their means."""
    a, b = cloud(n, seed), cloud(m, seed + 1) * [2, 1, 1] + [1, 0, 0]
    apart = float(np.square(a.mean(axis=0) - b.mean(axis=0)).sum())
    centered = squared(a - a.mean(axis=0), b - b.mean(axis=0))
    # each within 1e-9 of its truth, or 1e-12 of a box of some 10 squared
    assert squared(a, b) == pytest.approx(apart + centered, rel=2e-9, abs=1e-10)


@pytest.mark.parametrize(("n", "m"), [(300, 300), (1000, 700)])
def test_on_a_line_points_are_matched_in_order(n, m):
    """The integral over all quantiles of the square of their distance."""
    x, y = np.sort(cloud(n, 1)[:, 0]), np.sort(cloud(m, 2)[:, 0])
    cuts = np.unique(np.concatenate([np.arange(n + 1) * m, np.arange(m + 1) * n]))
    begin = cuts[:-1]
    expected = np.square(x[begin // m] - y[begin // n]) @ np.diff(cuts) / (n * m)
    a, b = (np.column_stack([z, np.zeros((len(z), 2))]) for z in (x, y))
    assert squared(a, b) == pytest.approx(expected, rel=1e-9)


def test_a_long_way_is_dearer_than_many_short_ones():
    """Eight moved on by one place of 2, or one by all of 16: as far in all, not squared."""
    a, b = (2 * np.arange(s, s + 8.0)[:, None] * [1, 0, 0] for s in (0, 1))
    assert emd(a, b).value == pytest.approx(2.0, rel=1e-9)
    assert squared(a, b) == pytest.approx(4.0, rel=1e-9)  # 256 / 8, if one went all the way


def test_the_unit_is_squared():
    a, b = cloud(50, 1), cloud(40, 2)
    assert squared(a * 1024, b * 1024) == squared(a, b) * 1024**2  # a power of two: exact


@pytest.mark.parametrize("unit", [2.0**600, 2.0**-600])
def test_a_square_beyond_float64_is_refused(unit):
    with pytest.raises(MetricError, match="does not fit into float64"):
        squared(cloud(5, 1) * unit, cloud(5, 2) * unit)
