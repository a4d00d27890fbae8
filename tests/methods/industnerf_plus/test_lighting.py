"""Light and finishes are found again from the brightness that they make."""

import numpy as np
import pytest

from industnerf.geometry.sphere import fibonacci_sphere
from industnerf.methods.industnerf_plus.finishes import fit_finishes, refit_lighting
from industnerf.methods.industnerf_plus.lighting import Lighting, fit_lighting, merge_lights

TRUE = Lighting(0.2, np.array([[0.3, 0.1, 0.2], [-0.1, 0.25, -0.3], [-0.2, -0.2, 0.05]]))
NORMALS = fibonacci_sphere(6000)


def test_light_is_found_whatever_a_tenth_of_the_pixels_shows():
    rng = np.random.default_rng(0)
    brightness = TRUE.brightness(NORMALS)
    is_wrong = rng.random(len(brightness)) < 0.1
    shown = np.where(is_wrong, rng.random(len(brightness)), brightness)
    error = fit_lighting(NORMALS, shown).brightness(NORMALS) - brightness
    assert np.abs(error).max() < 0.005


def test_lights_from_nearly_one_side_are_one_light():
    lights = np.array([[1.0, 0, 0], [0, 0.5, 0], [0.9, 0.1, 0], [0, 0, 1e-4]])
    merged = merge_lights(lights)
    np.testing.assert_allclose(merged, [[1.9, 0.1, 0], [0, 0.5, 0]])


def two_finishes(albedo: float, tint: tuple[float, float, float]):
    """Two balls, one of another finish: points, normals, colors and which they have."""
    label = (np.arange(len(NORMALS)) % 3 == 0).astype(int)
    points = 20 * NORMALS + 50 * label[:, None]
    scale = np.where(label[:, None] == 1, albedo * np.array(tint), 1.0)
    return points, TRUE.brightness(NORMALS)[:, None] * scale, label


@pytest.mark.parametrize(
    ("albedo", "tint"), [(0.6, (1, 1, 1)), (1.3, (1, 1, 1)), (0.9, (1.2, 1.0, 0.5))]
)
def test_a_second_finish_is_told_by_its_color_or_its_brightness(albedo, tint):
    points, rgb, label = two_finishes(albedo, tint)
    fit = fit_finishes(points, NORMALS, rgb)
    assert len(fit.albedo) == 2
    order = [np.bincount(fit.label[label == k], minlength=2).argmax() for k in (0, 1)]
    assert (fit.label == np.array(order)[label]).mean() > 0.97
    ratio = fit.albedo[order[1]] / fit.albedo[order[0]]
    assert ratio == pytest.approx(albedo * np.mean(tint), rel=0.02)
    assert fit.outlier_share < 0.03


def test_one_finish_stays_one_though_normals_are_wrong_in_places():
    """A plug has the normal of its rim, and the brightness of what is behind it."""
    rng = np.random.default_rng(1)
    shown = TRUE.brightness(NORMALS)
    is_plug = NORMALS @ np.array([0.6, 0.8, 0]) > 0.9
    shown = np.where(is_plug, TRUE.brightness(NORMALS[rng.permutation(len(NORMALS))]), shown)
    fit = fit_finishes(20 * NORMALS, NORMALS, np.repeat(shown[:, None], 3, axis=1))
    assert len(fit.albedo) == 1


def test_refining_keeps_the_finishes():
    points, rgb, _ = two_finishes(0.6, (1, 1, 1))
    fit = fit_finishes(points, NORMALS, rgb)
    half = slice(None, None, 2)
    again = refit_lighting(fit, fit.label[half], NORMALS[half], rgb[half])
    np.testing.assert_array_equal(again.albedo, fit.albedo)
    assert again.outlier_share <= fit.outlier_share + 0.01
