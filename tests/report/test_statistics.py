"""Intervals by cluster bootstrap."""

import numpy as np
import pytest

from industnerf.report.statistics import bootstrap_interval


def rng():
    return np.random.default_rng(0)


def test_equal_values_have_no_width():
    assert bootstrap_interval([2.0] * 6, list("aabbcc"), 100, 0.95, rng()) == (2.0, 2.0)


def test_one_part_a_family_is_the_plain_bootstrap():
    """Its standard error is that of a mean: 1.96 s / sqrt(n) either way."""
    values = np.random.default_rng(1).normal(size=400)
    families = [str(i) for i in range(400)]
    low, high = bootstrap_interval(list(values), families, 4000, 0.95, rng())
    expected = 1.96 * values.std() / np.sqrt(400)
    # 4000 draws place a 2.5 % quantile to about 5 % of the half-width (3 standard errors)
    assert (high - low) / 2 == pytest.approx(expected, rel=0.06)


def test_parts_of_a_family_do_not_count_as_independent():
    """Ten copies of every part in its family narrow nothing."""
    values, families = [float(i) for i in range(8)], [str(i) for i in range(8)]
    once = bootstrap_interval(values, families, 2000, 0.9, rng())
    tenfold = bootstrap_interval(values * 10, families * 10, 2000, 0.9, rng())
    assert once == pytest.approx(tenfold)


def test_one_family_gives_the_range():
    assert bootstrap_interval([1.0, 3.0, 2.0], ["a"] * 3, 100, 0.95, rng()) == (1.0, 3.0)
