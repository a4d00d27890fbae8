"""Which pixels are of the part: by color, and in spite of noise."""

import numpy as np
import pytest
from scipy.ndimage import binary_dilation, binary_erosion

from industnerf.geometry.silhouettes import (
    background_noise,
    differs_from_background,
    foreground_mask,
)

SIZE = 128
WHITE = np.ones((1, 3))
ROW, COLUMN = np.indices((SIZE, SIZE))
DISC = np.hypot(ROW - 60, COLUMN - 70) < 40
NOISES = [0.005, 0.01, 0.02, 0.05]


def synthetic_image(part, color, background=1.0, sigma=0.0, seed=0):
    """One photograph: `part` in `color` before the background, with noise."""
    image = np.where(part[..., None], color, background) * np.ones(3)
    image = image + sigma * np.random.default_rng(seed).standard_normal(image.shape)
    return (image.clip(0, 1) * 255).round().astype(np.uint8)[None]


def test_a_pixel_differs_if_one_channel_is_beyond_the_tolerance():
    background = np.array([1.0, 0.5, 0.0])
    rgb = np.array([[255, 128, 0], [250, 127, 5], [249, 127, 5], [255, 134, 0], [255, 128, 6]])
    mask = differs_from_background(
        rgb.astype(np.uint8).reshape(1, 1, 5, 3), background[None], 0.0205
    )
    # 0.0205 * 255 = 5.2: 5 levels are within, 6 beyond; 134 is 6.5 from 127.5
    np.testing.assert_array_equal(mask[0, 0], [False, False, True, True, True])


def test_each_view_has_its_own_background():
    background = np.array([[1.0, 1, 1], [0, 0, 0], [0.2, 0.4, 0.6]])
    rgb = np.array([[255, 255, 255], [0, 0, 0], [51, 102, 153]], np.uint8)
    images = np.tile(rgb, (3, 1, 1)).reshape(3, 1, 3, 3)
    masks = differs_from_background(images, background, 0.02)
    np.testing.assert_array_equal(masks[:, 0], ~np.eye(3, dtype=bool))


def test_without_noise_the_part_is_what_differs_to_the_pixel():
    dust = DISC ^ (np.random.default_rng(1).random(DISC.shape) < 0.02)  # specks and pinholes
    dust[[0, -1]] = dust[:, [0, -1]] = False
    image = synthetic_image(dust, 0.6)
    np.testing.assert_array_equal(
        foreground_mask(image, WHITE, 0.02), differs_from_background(image, WHITE, 0.02)
    )
    np.testing.assert_array_equal(foreground_mask(image, WHITE, 0.02)[0], dust)


@pytest.mark.parametrize("sigma", NOISES)
@pytest.mark.parametrize("behind", [1.0, 0.5])  # noise before white is cut off on one side
def test_noise_moves_the_outline_alone(sigma, behind):
    """Two erosions reach past what nine pixels can change at the outline."""
    image = synthetic_image(DISC, 0.2, behind, sigma)
    mask = foreground_mask(image, np.full((1, 3), behind), 0.02)[0]
    assert mask[binary_erosion(DISC, iterations=2)].all()
    assert not mask[~binary_dilation(DISC, iterations=2)].any()
    assert (mask != DISC).mean() < 0.001  # 16 of 16384; the outline is some 250 long


@pytest.mark.parametrize("sigma", NOISES)
def test_a_face_nearly_as_bright_as_the_background_is_seen_in_spite_of_noise(sigma):
    """At 3 sigma from white, where noise alone is taken to go to 3.3."""
    image = synthetic_image(DISC, 1 - max(0.03, 3 * sigma), sigma=sigma)
    mask = foreground_mask(image, WHITE, 0.02)[0]
    assert mask[binary_erosion(DISC, iterations=3)].mean() > 0.99
    assert mask[~binary_dilation(DISC, iterations=3)].mean() < 0.001


@pytest.mark.parametrize("sigma", NOISES)
def test_a_wire_one_pixel_wide_survives_noise(sigma):
    wire = (ROW == COLUMN // 2 + 20) & (COLUMN > 20) & (COLUMN < 100)
    mask = foreground_mask(synthetic_image(wire, 0.2, sigma=sigma), WHITE, 0.02)[0]
    assert (mask & wire).sum() >= 0.95 * wire.sum()  # its ends are specks


def test_each_view_has_its_own_noise():
    quiet, loud = synthetic_image(DISC, 0.9), synthetic_image(DISC, 0.4, sigma=0.05)
    masks = foreground_mask(np.concatenate([quiet, loud]), np.ones((2, 3)), 0.02)
    np.testing.assert_array_equal(masks[0], DISC)  # 0.1 from white, which is within 0.05's reach
    assert not masks[1][~binary_dilation(DISC, iterations=2)].any()


@pytest.mark.parametrize("sigma", NOISES)
def test_the_noise_measured_is_what_was_added(sigma):
    """Three quarters of the largest of three Gaussians are within 1.69 sigma."""
    image = synthetic_image(DISC, 0.2, 0.5, sigma)[0]
    # 8 bits round by 1/510; 508 pixels are of the border, which know it to some 3 %
    assert background_noise(image, np.full(3, 0.5)) == pytest.approx(
        1.69 * sigma, rel=0.1, abs=1 / 255
    )


@pytest.mark.parametrize("share", [0.3, 1.0])
def test_a_part_that_the_frame_cuts_is_no_noise(share):
    cut = share * SIZE > COLUMN
    image = synthetic_image(cut, 0.2)
    assert background_noise(image[0], WHITE[0]) == 0
    np.testing.assert_array_equal(foreground_mask(image, WHITE, 0.02)[0], cut)
