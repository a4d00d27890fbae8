"""Squared transport against closed forms and against an independent solver."""

import numpy as np
import pytest
from scipy.optimize import linprog
from scipy.spatial.distance import cdist

from industnerf.errors import MetricError
from industnerf.metrics.squared import squared_emd


def cloud(n, seed=0):
    return np.random.default_rng(seed).normal(size=(n, 3))


def test_a_shift_costs_its_square():
    # the plan that shifts every point is optimal: squared cost is the variance it cannot avoid
    shifted = cloud(200) + np.array([0.3, 0.0, 0.4])
    assert squared_emd(cloud(200), shifted) == pytest.approx(0.25, rel=1e-12)


def test_on_a_line_the_ranks_are_carried():
    a, b = (np.column_stack([cloud(300, s)[:, 0], np.zeros((300, 2))]) for s in (1, 2))
    expected = ((np.sort(a[:, 0]) - np.sort(b[:, 0])) ** 2).mean()
    assert squared_emd(a, b) == pytest.approx(expected, rel=1e-12)


def test_it_is_what_a_linear_program_says():
    a, b, n = cloud(12, 3), cloud(12, 4), 12
    sums = np.concatenate([np.kron(np.eye(n), np.ones(n)), np.kron(np.ones(n), np.eye(n))])
    found = linprog(cdist(a, b, "sqeuclidean").ravel(), A_eq=sums, b_eq=np.full(2 * n, 1 / n))
    assert squared_emd(a, b) == pytest.approx(found.fun, rel=1e-9)


def test_clouds_of_other_sizes_are_refused():
    with pytest.raises(MetricError, match="3 points cannot be assigned to 4"):
        squared_emd(cloud(3), cloud(4))
