"""From light to pixels: each step by its closed form, and the order of the steps."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.special import ndtr

from industnerf.capture.sensor import add_noise, blur, jpeg_roundtrip, quantize, simulate_sensor

SIDE = 64
RAMP = np.tile(np.linspace(0, 255, SIDE, dtype=np.float32), (SIDE, 1))


def rng() -> np.random.Generator:
    return np.random.default_rng(0)


def test_switched_off_the_sensor_rounds(shipped):
    light = np.array([[0.4, 0.6, 254.4, 254.6, 300.0, -3.0]], np.float32)
    image = simulate_sensor([light, light + 1, light], shipped.sensor, rng())
    np.testing.assert_array_equal(image[0, :, 0], [0, 1, 254, 255, 255, 0])
    np.testing.assert_array_equal(image[0, :, 1], [1, 2, 255, 255, 255, 0])


def test_blur_keeps_the_mean():
    """Float32: 1e-7 of 255, in each of some 30 weights."""
    light = rng().uniform(0, 255, (SIDE, SIDE)).astype(np.float32)
    assert blur(light, 2.5).mean(dtype=float) == pytest.approx(light.mean(dtype=float), abs=1e-3)


def test_an_edge_under_blur_is_the_normal_distribution():
    light = np.where(np.arange(SIDE) < SIDE // 2, 0, 255).astype(np.float32)
    row = blur(np.tile(light, (SIDE, 1)), 3.0)[5]
    truth = 255 * ndtr((np.arange(SIDE) + 0.5 - SIDE / 2) / 3.0)
    # weights sampled, not integrated: the midpoint rule is off by 1 / 24 of the density's slope,
    # which is 0.242 / 3^2 at most; and the kernel ends at 4 deviations, 6e-5
    np.testing.assert_allclose(row, truth, rtol=0, atol=255 * (0.242 / 9 / 24 + 6e-5) + 0.01)


def test_noise_has_its_deviation_and_no_mean():
    """16384 draws: the deviation is known to 0.55 %, five times that is chance once in 1e6."""
    plane = np.full((128, 128), 100, np.float32)
    rest = add_noise(plane, 0.04, rng()) - plane
    assert rest.std() == pytest.approx(0.04 * 255, rel=0.0276)
    assert rest.mean() == pytest.approx(0, abs=5 * 0.04 * 255 / 128)


def test_noise_is_independent_between_colors(shipped):
    plane = np.full((128, 128), 128, np.float32)
    image = simulate_sensor([plane] * 3, replace(shipped.sensor, noise=0.1), rng()).reshape(-1, 3)
    # correlations over 16384 pixels have a deviation of 1 / 128; five of them
    assert np.abs(np.corrcoef(image.T.astype(float)) - np.eye(3)).max() < 5 / 128


def test_too_much_light_spreads_before_it_is_cut_off(shipped):
    """A highlight of ten times white: had it been cut first, its halo would be a tenth."""
    light = np.zeros((SIDE, SIDE), np.float32)
    light[32, 32] = 2550
    image = simulate_sensor([light] * 3, replace(shipped.sensor, blur_px=2.0), rng())
    next_to_edge = 2550 * np.exp(-(2.0**2) / 8) / (2 * np.pi * 4)  # 2 px aside
    # the kernel is cut at 4 deviations and so 1e-4 too large; 8 bits round by half a level
    assert image[32, 34, 0] == pytest.approx(next_to_edge, abs=0.5 + 0.01 * next_to_edge)


def test_noise_comes_after_blur(shipped):
    """Blurred by 2 px, noise would lose all but 1 / (2 sqrt(pi) 2) = 14 % of its deviation."""
    sensor = replace(shipped.sensor, blur_px=2.0, noise=0.05)
    plane = np.full((128, 128), 128, np.float32)
    image = simulate_sensor([plane] * 3, sensor, rng()).astype(float)
    assert image.std() == pytest.approx(0.05 * 255, rel=0.03)


def test_jpeg_comes_last(shipped):
    sensor = replace(shipped.sensor, noise=0.05, jpeg_quality=30)
    both = simulate_sensor([RAMP] * 3, sensor, rng())
    noise_alone = simulate_sensor([RAMP] * 3, replace(sensor, jpeg_quality=0), rng())
    np.testing.assert_array_equal(both, jpeg_roundtrip(noise_alone, 30))
    assert (both != noise_alone).any()


def test_a_lower_quality_is_further_from_the_picture():
    rgb = rng().integers(0, 256, (SIDE, SIDE, 3)).astype(np.uint8)
    errors = [
        np.abs(jpeg_roundtrip(rgb, quality).astype(int) - rgb).mean() for quality in (95, 70, 30, 5)
    ]
    assert errors == sorted(errors)
    assert errors[0] < errors[-1]


def test_a_gray_of_one_level_survives_jpeg():
    """Its blocks have one coefficient, which is a multiple of 8 at any quality of 50 or more."""
    rgb = np.full((SIDE, SIDE, 3), 131, np.uint8)
    # the mean is quantized by at most 16 / 8 levels, so it is off by half of that
    assert np.abs(jpeg_roundtrip(rgb, 50).astype(int) - 131).max() <= 1


def test_rounding_is_to_the_nearest_level():
    light = np.linspace(0, 255, 1001, dtype=np.float32)[None]
    assert np.abs(quantize(light) - light).max() <= 0.5 + 1e-4
