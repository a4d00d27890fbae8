"""Subsets of cameras: each within the next, and spread."""

from itertools import pairwise

import numpy as np
import pytest

from industnerf.geometry.sphere import fibonacci_sphere
from industnerf.geometry.view_subsets import nested_view_subset


def test_each_number_includes_the_smaller_ones_and_all_are_different():
    positions = fibonacci_sphere(40)
    sets = [set(nested_view_subset(positions, count).tolist()) for count in range(1, 41)]
    assert sets[0] == {0}
    assert all(smaller < larger for smaller, larger in pairwise(sets))
    assert sets[-1] == set(range(40))


def test_the_farthest_comes_next():
    line = np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0], [9, 0, 0], [4, 0, 0]])
    assert nested_view_subset(line, 2).tolist() == [0, 3]
    assert nested_view_subset(line, 3).tolist() == [0, 3, 4]  # 4 is 4 from the next, 2 is 2
    assert nested_view_subset(line, 4).tolist() == [0, 2, 3, 4]


@pytest.mark.parametrize("count", [4, 8, 16])
def test_few_of_a_sphere_are_spread_over_it(count):
    """The nearest two are at least half as far apart as those of a sphere's lattice."""
    chosen, even = (
        np.linalg.norm(p[:, None] - p[None], axis=2)[~np.eye(count, dtype=bool)].min()
        for p in (
            fibonacci_sphere(40)[nested_view_subset(fibonacci_sphere(40), count)],
            fibonacci_sphere(count),
        )
    )
    assert chosen > 0.5 * even


def test_places_that_coincide_are_all_taken_once():
    assert nested_view_subset(np.zeros((3, 3)), 3).tolist() == [0, 1, 2]
