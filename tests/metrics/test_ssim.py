"""Structural similarity, against closed forms and a double loop over windows.

They hold scikit-image to the window and the constants of Wang et al. (2004).
"""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from industnerf.metrics.images import ssim_map

SIGMA, HALF_WINDOW = 1.5, 5  # px: a Gaussian window of 11 x 11
K1, K2 = 0.01, 0.03


def random_images(
    seed: int, count: int = 2, shape: tuple[int, ...] = (16, 19, 3)
) -> list[np.ndarray]:
    rng = np.random.default_rng(seed)
    return [rng.random(shape) for _ in range(count)]


@given(st.integers(0, 1000))
def test_equal_pictures_are_alike_and_no_others_more_so(seed):
    a, b = random_images(seed)
    # a picture's variance is the difference of two sums of 121 products, rounded alike
    np.testing.assert_allclose(ssim_map(a, a), 1, rtol=0, atol=1e-12)
    assert (np.abs(ssim_map(a, b)) <= 1 + 1e-12).all()


@given(st.integers(0, 1000))
def test_it_does_not_matter_which_comes_first(seed):
    a, b = random_images(seed)
    np.testing.assert_allclose(ssim_map(a, b), ssim_map(b, a), rtol=0, atol=1e-13)


@pytest.mark.parametrize(("a", "b"), [(0.0, 1.0), (0.2, 0.7), (0.5, 0.5)])
def test_flat_pictures_differ_in_brightness_alone(a, b):
    flat = [np.full((12, 12, 3), value) for value in (a, b)]
    expected = (2 * a * b + K1**2) / (a * a + b * b + K1**2)
    np.testing.assert_allclose(ssim_map(*flat), expected, rtol=0, atol=1e-12)


def test_it_is_that_of_every_window_by_itself():
    a, b = random_images(3)
    offsets = np.arange(-HALF_WINDOW, HALF_WINDOW + 1)
    weights = np.exp(-(offsets[:, None] ** 2 + offsets[None] ** 2) / (2 * SIGMA**2))
    weights /= weights.sum()
    similarity = ssim_map(a, b)
    for row in range(HALF_WINDOW, a.shape[0] - HALF_WINDOW):
        for column in range(HALF_WINDOW, a.shape[1] - HALF_WINDOW):
            mean = 0
            for channel in range(3):
                rows = slice(row - HALF_WINDOW, row + HALF_WINDOW + 1)
                columns = slice(column - HALF_WINDOW, column + HALF_WINDOW + 1)
                x, y = a[rows, columns, channel], b[rows, columns, channel]
                mx, my = (weights * x).sum(), (weights * y).sum()
                vx, vy = (weights * (x - mx) ** 2).sum(), (weights * (y - my) ** 2).sum()
                cov = (weights * (x - mx) * (y - my)).sum()
                brightness = (2 * mx * my + K1**2) / (mx**2 + my**2 + K1**2)
                mean += brightness * (2 * cov + K2**2) / (vx + vy + K2**2) / 3
            assert similarity[row, column] == pytest.approx(mean, rel=1e-12)


def test_beyond_the_border_the_picture_is_mirrored():
    a, b = random_images(4)
    wide = [np.pad(image, ((8, 8), (8, 8), (0, 0)), "symmetric") for image in (a, b)]
    np.testing.assert_allclose(ssim_map(*wide)[8:-8, 8:-8], ssim_map(a, b), rtol=0, atol=1e-13)


def test_images_smaller_than_the_window_have_one_too():
    a, b = random_images(5, shape=(4, 6, 3))
    wide = [np.pad(image, ((4, 4), (6, 6), (0, 0)), "symmetric") for image in (a, b)]
    np.testing.assert_allclose(ssim_map(a, b), ssim_map(*wide)[4:-4, 6:-6], rtol=0, atol=1e-13)
