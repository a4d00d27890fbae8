import numpy as np
import pytest

from industnerf.errors import MetricError
from industnerf.metrics.fscore import fscore, share_within
from industnerf.metrics.nearest_distances import nearest_distances


def on_axis(*x: float) -> np.ndarray:
    return np.array([[value, 0.0, 0.0] for value in x])


TRUTH = on_axis(0, 1, 2, 3)
PREDICTED = on_axis(0.5, 10)
DISTANCES = nearest_distances(TRUTH, PREDICTED)


def test_shares_are_directed():
    assert (
        share_within(DISTANCES.predicted_to_truth, 0.6) == 1 / 2
    )  # 0.5 is near 0, 10 near nothing
    assert share_within(DISTANCES.truth_to_predicted, 0.6) == 2 / 4  # 0 and 1 are near 0.5
    assert share_within(DISTANCES.truth_to_predicted, 1.6) == 3 / 4
    assert share_within(DISTANCES.predicted_to_truth, 1.6) == 1 / 2


def test_the_distance_itself_counts():
    assert share_within(DISTANCES.predicted_to_truth, 0.5) == 1 / 2
    assert share_within(DISTANCES.predicted_to_truth, np.nextafter(0.5, 0)) == 0


def test_fscore_is_the_harmonic_mean():
    precision, recall = 1 / 2, 3 / 4
    # Same two divisions and a product: a few eps.
    truth = 2 / (1 / precision + 1 / recall)
    assert fscore(DISTANCES, 1.6) == pytest.approx(truth, rel=1e-15)


def test_fscore_of_nothing_near_is_zero_and_of_the_truth_is_one():
    assert fscore(nearest_distances(TRUTH, on_axis(100)), 1.0) == 0
    assert fscore(nearest_distances(TRUTH, TRUTH), 1e-9) == 1


@pytest.mark.parametrize("distance", [0.0, -1.0, np.nan, np.inf])
def test_a_meaningless_distance_is_refused(distance):
    with pytest.raises(MetricError, match="positive length"):
        fscore(DISTANCES, distance)


def test_an_empty_prediction_is_refused():
    with pytest.raises(MetricError, match="empty"):
        nearest_distances(TRUTH, np.empty((0, 3)))
