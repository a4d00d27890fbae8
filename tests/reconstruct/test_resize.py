"""Smaller images are means over areas."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from industnerf.reconstruct.images import area_weights, resize_area

IMAGE = np.random.default_rng(0).integers(0, 256, (24, 36, 3), np.uint8)


def slow_mean(image, width, height):
    """The mean over each new pixel, on a grid so fine that old and new edges lie on it."""
    fine = image.repeat(height, axis=0).repeat(width, axis=1).astype(float)
    blocks = fine.reshape(height, image.shape[0], width, image.shape[1], 3)
    return blocks.mean(axis=(1, 3))


@pytest.mark.parametrize(("width", "height"), [(18, 12), (36, 24), (1, 1), (25, 17), (35, 23)])
def test_a_new_pixel_is_the_mean_of_what_it_covers(width, height):
    # half a level from rounding to whole ones, and float32 sums of numbers up to 255
    np.testing.assert_allclose(
        resize_area(IMAGE, width, height), slow_mean(IMAGE, width, height), rtol=0, atol=0.5 + 1e-3
    )


@given(st.integers(1, 300), st.data())
def test_old_pixels_are_shared_out_evenly(old, data):
    new = data.draw(st.integers(1, old))
    shares = area_weights(old, new).toarray()
    # float32 shares, of which a few hundred are added
    np.testing.assert_allclose(shares.sum(axis=1), 1, rtol=0, atol=1e-4)
    np.testing.assert_allclose(shares.sum(axis=0), new / old, rtol=0, atol=1e-4)
    assert (shares >= 0).all()
