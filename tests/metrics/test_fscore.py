import numpy as np
import pytest

from industnerf.errors import MetricError
from industnerf.metrics.fscore import fscore, share_within
from industnerf.metrics.gaps import between


def on_axis(*x: float) -> np.ndarray:
    return np.array([[value, 0.0, 0.0] for value in x])


TRUTH = on_axis(0, 1, 2, 3)
PREDICTED = on_axis(0.5, 10)
GAPS = between(TRUTH, PREDICTED)


def test_shares_are_directed():
    assert share_within(GAPS.predicted, 0.6) == 1 / 2  # 0.5 is near 0, 10 near nothing
    assert share_within(GAPS.truth, 0.6) == 2 / 4  # 0 and 1 are near 0.5
    assert share_within(GAPS.truth, 1.6) == 3 / 4
    assert share_within(GAPS.predicted, 1.6) == 1 / 2


def test_the_distance_itself_counts():
    assert share_within(GAPS.predicted, 0.5) == 1 / 2
    assert share_within(GAPS.predicted, np.nextafter(0.5, 0)) == 0


def test_fscore_is_the_harmonic_mean():
    precision, recall = 1 / 2, 3 / 4
    # Same two divisions and a product: a few eps.
    truth = 2 / (1 / precision + 1 / recall)
    assert fscore(GAPS, 1.6) == pytest.approx(truth, rel=1e-15)


def test_fscore_of_nothing_near_is_zero_and_of_the_truth_is_one():
    assert fscore(between(TRUTH, on_axis(100)), 1.0) == 0
    assert fscore(between(TRUTH, TRUTH), 1e-9) == 1


@pytest.mark.parametrize("distance", [0.0, -1.0, np.nan, np.inf])
def test_a_meaningless_distance_is_refused(distance):
    with pytest.raises(MetricError, match="positive length"):
        fscore(GAPS, distance)


def test_an_empty_prediction_is_refused():
    with pytest.raises(MetricError, match="empty"):
        between(TRUTH, np.empty((0, 3)))
