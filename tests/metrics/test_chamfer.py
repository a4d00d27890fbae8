import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.distance import cdist

from industnerf.errors import MetricError
from industnerf.metrics.chamfer import chamfer
from industnerf.metrics.nearest_distances import nearest_distances


def cloud(seed: int, n: int) -> np.ndarray:
    return np.random.default_rng(seed).normal(size=(n, 3))


SEEDS, SIZES = st.integers(0, 10**6), st.integers(1, 60)


def test_one_point_against_two():
    # From a: 3 to the nearer.  From b: 3 and 5, mean 4.  Half their sum: 3.5, in first order.
    a = np.array([[0.0, 0.0, 0.0]])
    b = np.array([[3.0, 0.0, 0.0], [0.0, 4.0, 3.0]])
    assert chamfer(nearest_distances(a, b)) == 3.5


@given(SEEDS, SIZES, SIZES)
def test_agrees_with_all_distances(seed, n, m):
    a, b = cloud(seed, n), cloud(seed + 1, m)
    all_pairs = cdist(a, b)
    truth = (all_pairs.min(axis=1).mean() + all_pairs.min(axis=0).mean()) / 2
    # Both add the same 120 distances, in another order: 120 eps.
    assert chamfer(nearest_distances(a, b)) == pytest.approx(truth, rel=1e-13)


@given(SEEDS, SIZES, SIZES)
def test_is_symmetric_and_scales(seed, n, m):
    a, b = cloud(seed, n), cloud(seed + 1, m)
    assert chamfer(nearest_distances(a, b)) == chamfer(nearest_distances(b, a))
    assert chamfer(nearest_distances(4 * a, 4 * b)) == 4 * chamfer(
        nearest_distances(a, b)
    )  # a power of two: exact


def test_a_shifted_grid_is_its_shift_away():
    """Spacing 1, shift 1/4: the nearest point is the shifted one."""
    grid = np.stack(np.meshgrid(*[np.arange(5.0)] * 3), axis=-1).reshape(-1, 3)
    assert chamfer(nearest_distances(grid, grid + np.array([0.25, 0, 0]))) == 0.25
    assert chamfer(nearest_distances(grid, grid)) == 0


@pytest.mark.parametrize("bad", [np.empty((0, 3)), np.array([[0.0, np.nan, 0.0]])])
def test_unusable_clouds_are_refused_by_name(bad):
    with pytest.raises(MetricError, match="'predicted'"):
        nearest_distances(np.zeros((1, 3)), bad)
