"""Answers in the unit cube to a reconstruction in mm."""

import numpy as np
import pytest

from industnerf.artifacts.state import ModelState
from industnerf.errors import ReconstructionFailed
from industnerf.geometry.bounding_cube import BoundingCube
from industnerf.methods.multi_view_predictions import predictions_to_reconstruction

FRAME = BoundingCube(np.array([100.0, -20.0, 3.0]), 40.0)
STATE = ModelState({}, num_parts=7, num_parameters=11, steps=5)
CORNERS, CENTER, NONE = np.array([[-0.5] * 3, [0.5] * 3]), np.zeros((1, 3)), np.zeros((0, 3))


def test_the_unit_cube_lies_round_the_part():
    one = predictions_to_reconstruction([CORNERS], FRAME, STATE)
    np.testing.assert_allclose(one.points_mm, [[80, -40, -17], [120, 0, 23]], rtol=1e-15)
    assert one.extra_clouds_mm == ()


def test_it_tells_what_was_trained():
    one = predictions_to_reconstruction([CORNERS], FRAME, STATE)
    assert (one.num_parameters, one.steps) == (11, 5)


def test_every_answer_is_kept_and_one_with_points_comes_first():
    some = predictions_to_reconstruction([NONE, CORNERS, NONE, CENTER], FRAME, STATE)
    assert [len(x) for x in (some.points_mm, *some.extra_clouds_mm)] == [2, 1, 0, 0]
    np.testing.assert_allclose(some.extra_clouds_mm[0], [[100, -20, 3]])


@pytest.mark.parametrize("clouds", [[NONE], [NONE] * 3])
def test_nothing_but_empty_answers_is_a_failure(clouds):
    with pytest.raises(ReconstructionFailed, match=f"all {len(clouds)} predictions .* are empty"):
        predictions_to_reconstruction(clouds, FRAME, STATE)
