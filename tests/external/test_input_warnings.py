"""What is remarked on of clouds from outside."""

import numpy as np

from industnerf.external.input_warnings import input_warnings
from tests import solids


def test_another_unit_and_another_place_are_remarked_on():
    truth = solids.box(20, 30, 40).vertices
    assert input_warnings(truth * 1.1, truth) == []
    assert "0.001 times as large" in input_warnings(truth / 1000, truth)[0]
    assert "25.4 times as large" in input_warnings(truth * 25.4, truth)[0]
    assert "another order" in input_warnings(truth[:, [0, 2, 1]], truth)[0]
    assert "diagonals from the part's" in input_warnings(truth + np.array([60, 0, 0]), truth)[0]


def test_points_that_float32_rounds_are_remarked_on():
    """At 1e6 its steps are 1/16 mm: 0.0012 of a diagonal of 53.9 mm."""
    truth = solids.box(20, 30, 40).vertices
    assert input_warnings(truth + 1000, truth + 1000) == []
    (warning,) = input_warnings(truth + 1e6, truth + 1e6)
    assert "reach 1e+06 mm" in warning
    assert "steps of 0.062 mm, 0.001 of the diagonal" in warning


def test_the_middle_of_many_points_far_from_the_origin_is_where_they_are():
    """As float32, the sum of a million coordinates of 1e4 errs by 1 % of it, several boxes."""
    truth = solids.box(20, 30, 40).vertices + 1e4
    points = np.tile(truth, (125_000, 1)).astype(np.float32)
    assert not [warning for warning in input_warnings(points, truth) if "middle" in warning]


def test_stray_points_are_not_taken_for_another_unit():
    """Of 10 001 points of a box one is a hundred boxes away; the others fill it."""
    truth = solids.box(20, 30, 40).vertices
    inside = np.random.default_rng(0).uniform(truth.min(axis=0), truth.max(axis=0), (10_000, 3))
    points = np.vstack([inside, [[5385.2, 0, 0]]])
    (warning,) = input_warnings(points, truth)
    assert "stray points: its box is 100 times as large" in warning
    assert "all but 1 of its 10001 points 1 times" in warning
    assert "in mm" not in warning
    strays, moved = input_warnings(points + np.array([60, 0, 0]), truth)
    assert (strays, "middle is 1.1 diagonals" in moved) == (warning, True)
    scaled = input_warnings(np.vstack([inside * 25.4, [[1e4, 0, 0]]]), truth)
    assert ["in mm?" in warning for warning in scaled] == [True]


def test_of_a_cad_file_of_one_s_own_the_unit_may_be_wrong_too():
    truth = solids.box(20, 30, 40).vertices
    assert "parts.units in params.yaml" in input_warnings(truth * 25.4, truth, is_user_cad=True)[0]
    assert "parts.units" not in input_warnings(truth * 25.4, truth)[0]
