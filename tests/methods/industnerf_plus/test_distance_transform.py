"""The distance transform, on either device, against SciPy's."""

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from scipy.ndimage import distance_transform_edt

from industnerf.methods.industnerf_plus.distance_transform import distance_transform, separable_edt

SEEDS = st.integers(0, 2**32 - 1)
SHARES = st.sampled_from([0.003, 0.1, 0.9])
every_transform = pytest.mark.parametrize("transform", [distance_transform, separable_edt])


@every_transform
@pytest.mark.parametrize("shape", [(3, 17, 40), (2, 9, 14, 11)])
@given(SEEDS, SHARES)
def test_distances_are_those_of_scipy(transform, shape, seed, share):
    """Roots of the same whole number, in float32 and in doubles."""
    mask = np.random.default_rng(seed).random(shape) < share
    mask[(slice(None), *[0] * (len(shape) - 1))] = True  # scipy knows no distance to nothing
    actual = transform(torch.from_numpy(mask)).numpy()
    expected = np.stack([distance_transform_edt(~single_mask) for single_mask in mask])
    np.testing.assert_allclose(actual, expected, rtol=2e-7)


def test_where_nothing_is_chosen_distances_are_the_sum_of_the_sides():
    mask = torch.zeros(2, 5, 8, dtype=torch.bool)
    mask[0, 2, 2] = True
    actual = distance_transform(mask)
    assert actual[0, 2, 2] == 0
    assert (actual[1] == 13).all()
    assert separable_edt(mask)[1].isinf().all()
