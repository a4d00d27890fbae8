"""The tree finds what brute force finds."""

import numpy as np
import torch
from hypothesis import given
from hypothesis import strategies as st

from industnerf.rendering.neighbors import neighbors


def by_brute_force(queries, points, radius, k):
    """Every distance, sorted, in our padding."""
    distance = np.linalg.norm(queries[:, None] - points, axis=2)
    distance = np.pad(distance, ((0, 0), (0, k)), constant_values=np.inf)
    ids = distance.argsort(axis=1)[:, :k]
    distance = np.take_along_axis(distance, ids, axis=1)
    is_near = distance < radius
    return np.where(is_near, ids, -1), np.where(is_near, distance, np.inf)


@given(st.integers(0, 2**32 - 1), st.integers(1, 40), st.integers(1, 12), st.floats(0.05, 1.0))
def test_brute_force_finds_the_same(seed, m, k, radius):
    rng = np.random.default_rng(seed)
    queries, points = rng.random((25, 3)), rng.random((m, 3))
    ids, distance = neighbors(torch.from_numpy(queries), torch.from_numpy(points), radius, k)
    true_ids, true_distance = by_brute_force(queries, points, radius, k)
    np.testing.assert_array_equal(ids, true_ids)
    # three squares, two sums, a root: a few eps
    np.testing.assert_allclose(distance, true_distance, rtol=1e-14, atol=0)


def test_a_point_at_the_radius_is_no_neighbor():
    points = torch.tensor([[0.5, 0, 0], [0, 0.25, 0]])
    ids, distance = neighbors(torch.zeros(1, 3), points, 0.5, 2)
    assert ids.tolist() == [[1, -1]]
    assert distance.tolist() == [[0.25, torch.inf]]


def test_a_small_cloud_is_padded():
    ids, distance = neighbors(torch.zeros(1, 3), torch.zeros(1, 3), 1.0, 3)
    assert ids.tolist() == [[0, -1, -1]]
    assert distance.tolist() == [[0, torch.inf, torch.inf]]


def test_no_cloud_and_no_queries():
    assert (neighbors(torch.zeros(4, 3), torch.empty(0, 3), 1.0, 2)[0] == -1).all()
    assert neighbors(torch.empty(0, 3), torch.zeros(4, 3), 1.0, 2)[0].shape == (0, 2)


def test_float32_far_from_the_origin_keeps_its_digits():
    """|a|^2 + |b|^2 - 2ab, with squares of 750 000 known to 0.06, knows no 0.125^2."""
    points = torch.tensor([[500.0, 500, 500]]).repeat(40, 1)
    aside = torch.tensor([0.125, 0, 0])  # exact in float32 at 500
    _, distance = neighbors(points + aside, points, 0.25, 1)
    assert distance.unique().tolist() == [0.125]


def test_positions_are_constants():
    points = torch.rand(5, 3, requires_grad=True)
    assert not neighbors(points, points, 1.0, 2)[1].requires_grad
