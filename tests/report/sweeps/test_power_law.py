"""Power laws by least squares in logarithms."""

import numpy as np
import pytest
from scipy.stats import linregress

from industnerf.report.sweeps.series import power_law


def test_a_power_law_is_found_exactly():
    law = power_law([1, 2, 4, 8], [3.0, 24.0, 192.0, 1536.0])  # 3 x^3
    assert law is not None
    assert law.exponent == pytest.approx(3.0)
    assert law.factor == pytest.approx(3.0)
    assert law.error == pytest.approx(0.0, abs=1e-9)
    assert law.points == 4


def test_exponent_and_error_are_those_of_a_regression_line():
    rng = np.random.default_rng(0)
    x = rng.uniform(1, 100, 20)
    y = 0.5 * x**1.3 * np.exp(rng.normal(0, 0.2, 20))
    law, line = power_law(list(x), list(y)), linregress(np.log(x), np.log(y))
    assert law is not None
    assert (law.exponent, law.error) == pytest.approx((line.slope, line.stderr))
    assert np.log(law.factor) == pytest.approx(line.intercept)


def test_the_error_covers_the_truth_as_often_as_it_should():
    """Within twice the standard error: t with 8 degrees of freedom says 92 %."""
    rng, x, hits = np.random.default_rng(1), np.geomspace(1, 100, 10), 0
    for _ in range(500):
        law = power_law(list(x), list(x**2 * np.exp(rng.normal(0, 0.3, 10))))
        hits += law is not None and abs(law.exponent - 2) < 2 * law.error
    # a share of 0.92 of 500 has a standard error of 0.012
    assert hits / 500 == pytest.approx(0.92, abs=0.04)


def test_the_unit_does_not_matter():
    a, b = power_law([1, 2, 3], [1, 5, 6]), power_law([10, 20, 30], [7, 35, 42])
    assert a is not None
    assert b is not None
    assert (a.exponent, a.error) == pytest.approx((b.exponent, b.error))


def test_points_without_a_logarithm_are_left_out():
    law = power_law([0, 1, 2, 4], [9, 2, 4, 8])
    assert law is not None
    assert (law.points, law.exponent) == (3, pytest.approx(1.0))


@pytest.mark.parametrize("x", [[1, 2], [0, 1, 2], [3, 3, 3]])
def test_too_few_points_have_no_law(x):
    assert power_law(x, [1.0] * len(x)) is None
