"""The distance transform, on either device, against SciPy's."""

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from scipy.ndimage import distance_transform_edt

from industnerf.methods.industnerf.distances import along_the_axes, distance_transform

SEEDS = st.integers(0, 2**32 - 1)
SHARES = st.sampled_from([0.003, 0.1, 0.9])
WAYS = pytest.mark.parametrize("way", [distance_transform, along_the_axes])


@WAYS
@pytest.mark.parametrize("shape", [(3, 17, 40), (2, 9, 14, 11)])
@given(SEEDS, SHARES)
def test_distances_are_those_of_scipy(way, shape, seed, share):
    """Roots of the same whole number, in float32 and in doubles."""
    chosen = np.random.default_rng(seed).random(shape) < share
    chosen[(slice(None), *[0] * (len(shape) - 1))] = True  # scipy knows no distance to nothing
    found = way(torch.from_numpy(chosen)).numpy()
    twin = np.stack([distance_transform_edt(~one) for one in chosen])
    np.testing.assert_allclose(found, twin, rtol=2e-7)


def test_where_nothing_is_chosen_distances_are_the_sum_of_the_sides():
    chosen = torch.zeros(2, 5, 8, dtype=torch.bool)
    chosen[0, 2, 2] = True
    found = distance_transform(chosen)
    assert found[0, 2, 2] == 0
    assert (found[1] == 13).all()
    assert along_the_axes(chosen)[1].isinf().all()
