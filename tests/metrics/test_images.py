"""Errors of pictures: over which pixels each is, by pictures small enough to count."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from industnerf.metrics.images import NormalizedImage, mean_over_views, psnr, view_scores

HIGH, WIDE = 6, 10
UNION, FRAME = "P1-union", "P1-frame"


def bar_image(columns: slice, color: float = 0.5, depth: float = 3.0) -> NormalizedImage:
    """A flat bar over `columns` before white."""
    mask = np.zeros((HIGH, WIDE), bool)
    mask[:, columns] = True
    rgb = np.where(mask[..., None], color, 1.0).repeat(3, axis=-1)
    return NormalizedImage(rgb, np.where(mask, depth, 0.0), mask)


TRUTH = bar_image(slice(0, 4))


def test_the_truth_rendered_is_perfect():
    best = {"rgb_mse": 0, "ssim": 1, "depth_mse": 0, "coverage": 1, "silhouette_iou": 1}
    best["psnr"] = psnr(0.0)
    values = view_scores(TRUTH, TRUTH)
    assert len(values) == 10
    for (metric, _), value in values.items():
        assert value == pytest.approx(best[metric], abs=1e-12), metric


def test_a_shifted_bar_is_counted_pixel_by_pixel():
    """Of 10 columns, the truth has 0 to 3, the rendering 2 to 5: 2 are common, the union has 6."""
    values = view_scores(TRUTH, bar_image(slice(2, 6), depth=3.1))
    # 4 columns of the union, half of them with each, differ by 0.5
    assert values["rgb_mse", UNION] == pytest.approx(4 / 6 * 0.25)
    assert values["rgb_mse", FRAME] == pytest.approx(4 / 10 * 0.25)
    assert values["psnr", FRAME] == pytest.approx(10)  # of a mean squared error of 0.1
    # depth is off by 0.1 where both have one: 2 columns; 4 more are empty in both
    assert values["depth_mse", UNION] == pytest.approx(0.01)
    assert values["depth_mse", FRAME] == pytest.approx(2 / 6 * 0.01)
    assert values["coverage", UNION] == pytest.approx(2 / 4)
    assert values["silhouette_iou", UNION] == pytest.approx(2 / 6)


def test_background_pulls_the_whole_frame_towards_perfect_similarity():
    values = view_scores(TRUTH, bar_image(slice(0, 4), color=0.9))
    assert values["ssim", UNION] < values["ssim", FRAME] < 1


def test_a_depth_without_opacity_covers_but_is_no_silhouette():
    values = view_scores(TRUTH, replace(TRUTH, foreground=np.zeros_like(TRUTH.foreground)))
    assert values["coverage", UNION] == 1
    assert values["depth_mse", UNION] == 0
    assert values["silhouette_iou", UNION] == 0


def test_what_has_no_pixel_has_no_value():
    nothing = bar_image(slice(0, 0))
    kinds = set(view_scores(TRUTH, nothing))
    assert ("depth_mse", UNION) not in kinds
    assert ("coverage", UNION) in kinds
    assert {protocol for _, protocol in view_scores(nothing, nothing)} == {FRAME}


def test_a_mean_is_over_the_views_that_have_the_value():
    nothing = bar_image(slice(0, 0))
    off = bar_image(slice(0, 4), depth=3.2)
    means = mean_over_views(iter([(TRUTH, TRUTH), (TRUTH, off), (TRUTH, nothing)]))
    assert means["depth_mse", UNION] == pytest.approx((0 + 0.04) / 2)
    assert means["coverage", UNION] == pytest.approx((1 + 1 + 0) / 3)
    assert means["psnr", UNION] == pytest.approx((psnr(0.0) + psnr(0.0) + psnr(0.25)) / 3)
    assert mean_over_views(iter([])) == {}


@pytest.mark.parametrize(("mse", "expected"), [(1.0, 0), (0.1, 10), (1e-4, 40), (0.0, 58.92)])
def test_psnr_is_its_definition_and_finite(mse, expected):
    # 20 log10(255) + 10 log10(12) = 48.131 + 10.792
    assert psnr(mse) == pytest.approx(expected, abs=0.005)


def test_the_error_hidden_by_rounding_is_that_of_rounding():
    """Colors that are anything, rounded to 8 bits."""
    colors = np.random.default_rng(0).random(200_000)
    mse = ((np.rint(255 * colors) / 255 - colors) ** 2).mean()
    # the mean of 200 000 squares, each with a standard deviation of 0.9 of it: 0.2 % a sigma
    assert psnr(mse) == pytest.approx(psnr(0.0), abs=10 / np.log(10) * 0.01)


@given(st.integers(0, 1000))
def test_values_are_in_their_range_and_neither_side_is_privileged(seed):
    rng = np.random.default_rng(seed)
    a, b = (
        NormalizedImage(
            rng.random((HIGH, WIDE, 3)),
            np.where(mask := rng.random((HIGH, WIDE)) < 0.6, rng.uniform(2, 5, mask.shape), 0.0),
            mask,
        )
        for _ in range(2)
    )
    one, other = view_scores(a, b), view_scores(b, a)
    for kind, value in one.items():
        assert np.isfinite(value)
        if kind[0] != "coverage":
            assert other[kind] == pytest.approx(value, abs=1e-12)
    assert 0 <= one["silhouette_iou", UNION] <= one["coverage", UNION] <= 1
