"""Whether points are enough, and as many everywhere."""

import numpy as np
import pytest

from industnerf.external.density import density_warnings
from industnerf.geometry.sampling import sample_surface
from tests import solids

BOX = solids.box(20, 30, 40)


def warnings(points, compared=1000):
    return density_warnings(points, BOX, compared, np.random.default_rng(1))


def random_points(count):
    return sample_surface(BOX.vertices, BOX.faces, count, np.random.default_rng(0))[0]


def test_few_points_are_remarked_on_with_what_so_many_perfect_ones_score():
    """The floors were measured: 1.65 of as many points as are compared, 3.8 of an eighth."""
    (warning,) = warnings(random_points(1000))
    assert warning.startswith("1000 points, of which the 1000 most evenly spread are compared")
    assert "score about 1.6 floors; write 4000 or more" in warning or "about 1.7" in warning
    (warning,) = warnings(random_points(100))
    assert warning.startswith("100 points, fewer than the 1000 that are compared")
    assert "about 3.8 floors" in warning
    assert warnings(random_points(4000)) == []


@pytest.mark.parametrize("count", [200, 4000, 20_000])
def test_points_at_random_are_even(count):
    assert warnings(random_points(count), compared=50) == []


def test_ten_times_as_many_on_one_side_are_uneven():
    points = random_points(40_000)
    few = np.random.default_rng(2).random(len(points)) < 0.1
    (warning,) = warnings(points[few | (points[:, 2] > 0)])
    factor = float(warning.split("surface has ")[1].split()[0])
    assert 7 < factor < 14  # ten, and what chance adds


def test_a_side_that_was_not_scanned_is_no_uneven_density():
    points = random_points(40_000)
    assert warnings(points[points[:, 2] > 0]) == []
