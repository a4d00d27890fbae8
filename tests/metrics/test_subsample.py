import numpy as np
import pytest

from industnerf.errors import MetricError
from industnerf.metrics.subsample import farthest_points, random_points


def greedy_farthest_points(points: np.ndarray, start: np.ndarray, count: int) -> np.ndarray:
    """The definition: each next point is the farthest from all before."""
    subset, distances = [start], np.linalg.norm(points - start, axis=1)
    while len(subset) < count:
        subset.append(points[distances.argmax()])
        distances = np.minimum(distances, np.linalg.norm(points - subset[-1], axis=1))
    return np.array(subset)


@pytest.mark.parametrize("n", [2, 3, 40, 127, 128, 2000])
def test_farthest_points_are_the_farthest(n):
    # Random points: no two distances are so alike that float32 could swap them (checked by
    # equality: a swap would show).
    points = np.random.default_rng(n).normal(size=(n, 3))
    count = max(1, n // 3)
    subset = farthest_points(points, count)
    np.testing.assert_array_equal(subset, greedy_farthest_points(points, subset[0], count))


def test_farthest_points_far_from_the_origin_keep_their_spacing():
    # In float32, 1e6 mm from the origin, points are 1/16 mm apart at best and merge.
    points = np.random.default_rng(1).uniform(size=(500, 3))
    near, far = farthest_points(points, 50), farthest_points(points + 2.0**20, 50)
    np.testing.assert_allclose(far - 2.0**20, near, rtol=0, atol=1e-9)  # 2^20 eps = 2e-10


def test_same_points_same_choice():
    points = np.random.default_rng(2).normal(size=(3000, 3))
    np.testing.assert_array_equal(farthest_points(points, 100), farthest_points(points, 100))


def test_coinciding_points_are_taken_once_each():
    """Ten places, fifty points in each: after the tenth choice nothing is far from anything."""
    positions = np.random.default_rng(3).normal(size=(10, 3))
    labeled = np.repeat(positions, 50, axis=0) + np.arange(500)[:, None] * 1e-13
    subset = farthest_points(labeled, 200)
    assert len(np.unique(subset, axis=0)) == 200


def test_random_points_are_a_subset_in_order():
    points = np.arange(300.0).reshape(100, 3)
    subset = random_points(points, 10, np.random.default_rng(4))
    assert len(subset) == 10
    assert (np.diff(subset[:, 0]) > 0).all()
    assert np.isin(subset[:, 0], points[:, 0]).all()


def test_random_points_follow_the_generator():
    points = np.random.default_rng(5).normal(size=(1000, 3))
    first, same, other = (random_points(points, 10, np.random.default_rng(s)) for s in (1, 1, 2))
    np.testing.assert_array_equal(first, same)
    assert not np.array_equal(first, other)


def test_random_points_are_equally_likely():
    # 2000 draws of 3 out of 6: each point 1000 times, standard error sqrt(2000/4) = 22; five of
    # them are exceeded by one of six points less than once in 10^5 seeds.
    points, rng = np.arange(18.0).reshape(6, 3), np.random.default_rng(6)
    counts = np.concatenate([random_points(points, 3, rng)[:, 0] for _ in range(2000)])
    assert abs(np.unique(counts, return_counts=True)[1] - 1000).max() < 5 * 22


@pytest.mark.parametrize("count", [5, 6])
def test_few_points_stay_as_they_are(count):
    points = np.random.default_rng(7).normal(size=(5, 3))
    assert farthest_points(points, count) is points
    assert random_points(points, count, np.random.default_rng(0)) is points


def test_no_points_at_all_are_refused():
    points = np.ones((5, 3))
    with pytest.raises(MetricError, match="0 points"):
        farthest_points(points, 0)
    with pytest.raises(MetricError, match="0 points"):
        random_points(points, 0, np.random.default_rng(0))
