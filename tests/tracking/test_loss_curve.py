"""Loss curves as MLflow is given them."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from industnerf.artifacts.history import History
from industnerf.tracking.loss_curve import MAX_CURVE_POINTS, loss_curve


def save_history(clouds: Path, part: str, steps, loss) -> None:
    (clouds / part).mkdir(parents=True)
    History(np.asarray(steps), np.asarray(loss, float), {"level 0": 0}).save(clouds / part)


def test_a_short_curve_is_the_mean_of_the_parts(tmp_path):
    save_history(tmp_path, "a", [0, 1, 2], [4, 2, 1])
    save_history(tmp_path, "b", [0, 1], [2, 0])
    (tmp_path / "without").mkdir()
    assert loss_curve(tmp_path) == {0: 3, 1: 1, 2: 1}


@pytest.mark.parametrize(
    "length",
    [MAX_CURVE_POINTS, MAX_CURVE_POINTS + 1, 2 * MAX_CURVE_POINTS - 1, 7 * MAX_CURVE_POINTS, 1234],
)
def test_a_long_curve_is_thinned_and_keeps_its_course(tmp_path, length):
    """Of a loss that falls by 1 a step, each stretch's mean is the middle of its own steps."""
    save_history(tmp_path, "a", np.arange(length), -np.arange(length))
    curve = loss_curve(tmp_path)
    starts = [*curve, length]
    assert len(curve) == MAX_CURVE_POINTS
    assert starts[0] == 0
    for start, end in pairwise(starts):
        assert curve[start] == -(start + end - 1) / 2  # sums of small whole numbers: exact


def test_steps_that_were_not_kept_leave_no_gap(tmp_path):
    save_history(tmp_path, "a", [0, 700, 1000], [4, 2, 1])
    assert list(loss_curve(tmp_path).values()) == [4, 2, 1]


def test_no_history_is_no_curve(tmp_path):
    assert loss_curve(tmp_path) == {}
