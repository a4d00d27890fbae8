"""What is remarked on of clouds from outside."""

import numpy as np

from industnerf.outside.oddities import oddities
from tests import solids


def test_another_unit_and_another_place_are_remarked_on():
    truth = solids.box(20, 30, 40).vertices
    assert oddities(truth * 1.1, truth) == []
    assert "0.001 times as large" in oddities(truth / 1000, truth)[0]
    assert "25.4 times as large" in oddities(truth * 25.4, truth)[0]
    assert "another order" in oddities(truth[:, [0, 2, 1]], truth)[0]
    assert "diagonals from the part's" in oddities(truth + np.array([60, 0, 0]), truth)[0]


def test_points_that_float32_rounds_are_remarked_on():
    """At 1e6 its steps are 1/16 mm: 0.0012 of a diagonal of 53.9 mm."""
    truth = solids.box(20, 30, 40).vertices
    assert oddities(truth + 1000, truth + 1000) == []
    (said,) = oddities(truth + 1e6, truth + 1e6)
    assert "reach 1e+06 mm" in said
    assert "steps of 0.062 mm, 0.001 of the part's diagonal" in said


def test_the_middle_of_many_points_far_from_the_origin_is_where_they_are():
    """As float32, the sum of a million coordinates of 1e4 errs by 1 % of it, several boxes."""
    truth = solids.box(20, 30, 40).vertices + 1e4
    points = np.tile(truth, (125_000, 1)).astype(np.float32)
    assert not [said for said in oddities(points, truth) if "middle" in said]
