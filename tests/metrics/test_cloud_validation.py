import numpy as np
import pytest

from industnerf.errors import MetricError
from industnerf.metrics.cloud_validation import validate_cloud


@pytest.mark.parametrize(
    ("cloud", "message"),
    [
        (np.zeros((5, 2)), r"'a' has shape \(5, 2\)"),
        (np.zeros(3), r"'a' has shape \(3,\)"),
        (5.0, r"'a' has shape \(\)"),
        ([[0, 0, 0], [0, 0]], r"'a' is no array of points \(n, 3\)"),
        (np.zeros((2, 3), complex), "'a' is of complex128; coordinates must be real"),
        ([["0", "1", "2"]], "'a' is of <U1"),
        (None, "'a' is of object"),
        (np.zeros((0, 3)), "'a' is empty"),
        (np.array([[0, 0, 0], [0, np.nan, 0], [0, 0, np.inf]]), "'a' has 2 of 3 .* row 1"),
    ],
)
def test_a_refusal_says_what_is_wrong(cloud, message):
    with pytest.raises(MetricError, match=message):
        validate_cloud(cloud, "a")


@pytest.mark.parametrize("dtype", [np.float32, np.float64, np.int64])
def test_a_good_cloud_comes_back_in_float64(dtype):
    points = validate_cloud(np.ones((2, 3), dtype), "a")
    assert points.dtype == np.float64
    np.testing.assert_array_equal(points, 1)
