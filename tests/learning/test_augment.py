"""Augmentations against what rolls, zooms and colors do to known pictures."""

import numpy as np
import pytest
import torch

from industnerf.learning.augment import augment, contrast_to_background
from industnerf.schema import AugmentSettings

# A float32 sum of four corners with weights from a float32 grid: 1e-7 each, times the slope
# between pixels (1 a pixel) and the size in pixels (16 at most).
ROUNDING = {"rtol": 0, "atol": 1e-5}


class FixedDraws(np.random.Generator):
    """Draws the upper end of every range, or so much of the way there from the lower."""

    def __init__(self, share: float = 1.0) -> None:
        super().__init__(np.random.PCG64(0))
        self.share = share

    def uniform(self, low=0.0, high=1.0, size=None):
        return np.full(size, low + self.share * (high - low))


def random_contrasts(n=2, size=8):
    """From -1 to 1."""
    return torch.from_numpy(2 * np.random.default_rng(0).random((n, 3, size, size), np.float32) - 1)


def augmentation(images, roll_deg=0.0, zoom=0.0, color=0.0, noise=0.0, rng=None):
    return augment(images, AugmentSettings(roll_deg, zoom, color, noise), rng or FixedDraws())[0]


def ramp(size=16):
    """As bright as its place across: -1 to 1 becomes 0.1 to 0.9."""
    across = (2 * np.arange(size) + 1) / size - 1
    row = torch.tensor(0.5 + 0.4 * across, dtype=torch.float32)
    return row.expand(1, 3, size, size), across


def test_no_augmentation_is_the_identity():
    contrasts = random_contrasts()
    result = augmentation(contrasts, rng=np.random.default_rng(3))
    np.testing.assert_allclose(result, contrasts, **ROUNDING)


@pytest.mark.parametrize(("share", "turns"), [(1.0, 1), (0.0, -1)])
def test_a_roll_of_90_degrees_is_a_quarter_turn(share, turns):
    """Up to +90: the picture turns anticlockwise, as `np.rot90` turns it; up to -90: back."""
    contrasts = random_contrasts()
    result = augmentation(contrasts, roll_deg=90.0, rng=FixedDraws(share))
    np.testing.assert_allclose(result, np.rot90(contrasts, turns, axes=(2, 3)), **ROUNDING)


@pytest.mark.parametrize(("roll", "zoom"), [(30.0, 0.0), (-70.0, 0.0), (0.0, 0.3), (-40.0, 0.3)])
def test_a_point_moves_as_its_picture_does(roll, zoom):
    """A spot of which the matrix says where it goes, in picture axes: right, down and forwards."""
    place = (torch.arange(65) + 0.5) / 65 - 0.5
    right, down = place - 17 / 65, place[:, None]
    spot = (-((right**2 + down**2) * (65 / 2) ** 2) / 2).exp().expand(1, 3, 65, 65)  # 2 px wide
    rng = FixedDraws(0.0 if roll < 0 else 1.0)
    moved, (matrix,) = augment(spot, AugmentSettings(abs(roll), zoom, 0.0, 0.0), rng)
    mass = moved[0, 0]
    position = [(mass.sum(dim=axis) * place).sum() / mass.sum() for axis in (0, 1)]
    point = np.array([17 / 65, 0.0, 0.8])
    np.testing.assert_allclose(position, (point @ matrix)[:2], atol=0.02 / 65)
    factor = 1 - zoom if roll < 0 else 1 + zoom
    np.testing.assert_allclose(matrix @ matrix.T, factor**2 * np.eye(3), atol=1e-12)
    assert np.linalg.det(matrix) > 0


def test_zoom_enlarges_about_the_center():
    image, across = ramp()
    result = augmentation(image, zoom=0.5)
    # 1.5 times as large: what was at x / 1.5 is now at x, and a ramp is read off exactly
    expected = np.broadcast_to(0.5 + 0.4 * across / 1.5, result.shape)
    np.testing.assert_allclose(result, expected, **ROUNDING)


def test_beyond_its_border_a_picture_goes_on_as_it_is_there():
    image, across = ramp()
    result = augmentation(image, zoom=0.5, rng=FixedDraws(0.0))
    # half as large: the ramp is twice as steep, up to the centers of the last pixels
    expected = np.broadcast_to(0.5 + 0.4 * np.clip(2 * across, across[0], across[-1]), result.shape)
    np.testing.assert_allclose(result, expected, **ROUNDING)


def test_the_background_stays_0():
    contrasts = torch.zeros(8, 3, 16, 16)
    contrasts[:, :, 5:10, 6:9] = 0.8
    result = augmentation(
        contrasts, roll_deg=180.0, zoom=0.2, color=0.5, rng=np.random.default_rng(0)
    )
    # the part is within 3.2 px of the middle, times 1.2 and a pixel of blur: 5 px, the edge is at 7
    assert not result[:, :, [0, -1]].any()
    assert not result[..., [0, -1]].any()
    assert result.flatten(1).any(dim=1).all()


def test_colors_are_scaled_and_cut():
    contrasts = random_contrasts()
    stronger = augmentation(contrasts, color=0.4)
    np.testing.assert_allclose(stronger, (1.4 * contrasts).clamp(-1, 1), **ROUNDING)
    weaker = augmentation(contrasts, color=0.4, rng=FixedDraws(0.0))
    np.testing.assert_allclose(weaker, 0.6 * contrasts, **ROUNDING)
    assert (stronger.min(), stronger.max()) == (-1, 1)


def test_each_color_has_a_factor_of_its_own():
    contrasts = torch.full((2, 3, 4, 4), 0.5)
    factors = augmentation(contrasts, color=0.4, rng=np.random.default_rng(0))[..., 0, 0] / 0.5
    assert len(np.unique(factors)) == 6
    assert ((factors > 0.6) & (factors < 1.4)).all()


def handedness(images):
    """Sign of the area of the triangle red, green, blue, each channel's mass taken as a point."""
    place = torch.arange(images.shape[-1], dtype=torch.float32)
    mass = images.sum(dim=(2, 3))
    x = (images.sum(dim=2) * place).sum(dim=2) / mass
    y = (images.sum(dim=3) * place).sum(dim=2) / mass
    a, b = (torch.stack([x[:, i] - x[:, 0], y[:, i] - y[:, 0]], dim=1) for i in (1, 2))
    return (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sign()


def test_no_picture_is_ever_mirrored():
    image = torch.zeros(1, 3, 32, 32)
    for channel, (row, column) in enumerate([(10, 10), (10, 20), (22, 10)]):
        image[0, channel, row : row + 3, column : column + 3] = 1
    result = augmentation(
        image.expand(200, -1, -1, -1), roll_deg=180.0, zoom=0.2, rng=np.random.default_rng(0)
    )
    assert (handedness(result) == handedness(image)).all()
    assert (handedness(result.flip(3)) != handedness(image)).all()


@pytest.mark.parametrize(
    "some", [{"roll_deg": 30.0}, {"zoom": 0.1}, {"color": 0.2}, {"noise": 0.1}]
)
def test_every_picture_has_draws_of_its_own_and_a_seed_repeats_them(some):
    contrasts = random_contrasts(1).expand(3, -1, -1, -1)
    first, again = (augmentation(contrasts, **some, rng=np.random.default_rng(5)) for _ in range(2))
    assert torch.equal(first, again)
    assert not torch.allclose(first[0], first[1])
    assert not torch.allclose(first[1], first[2])


BACKGROUND = np.array([[1.0, 1.0, 1.0], [0.0, 0.0, 0.0], [0.2, 0.5, 0.9]])


def test_contrast_is_background_less_image_channels_first():
    images = np.zeros((1, 2, 3, 3), np.uint8)
    images[0, 1, 2] = [255, 51, 0]
    contrasts = contrast_to_background(images, BACKGROUND[2:], torch.device("cpu"))
    assert contrasts.shape == (1, 3, 2, 3)
    np.testing.assert_allclose(contrasts[0, :, 1, 2], [0.2 - 1, 0.5 - 0.2, 0.9], rtol=0, atol=1e-6)
    np.testing.assert_allclose(contrasts[0, :, 0, 0], BACKGROUND[2], rtol=0, atol=1e-6)


def test_contrast_is_0_where_the_part_is_not_whatever_the_background():
    images = np.tile(np.rint(255 * BACKGROUND)[:, None, None].astype(np.uint8), (1, 4, 5, 1))
    contrasts = contrast_to_background(images, BACKGROUND, torch.device("cpu"))
    assert contrasts.dtype == torch.float32
    assert contrasts.abs().max() <= 0.5 / 255 + 1e-6  # a color is rounded to 8 bits


def test_noise_has_its_deviation_and_contrasts_stay_in_range():
    contrasts = torch.full((4, 3, 64, 64), 0.5)
    result = augmentation(contrasts, noise=0.1, rng=np.random.default_rng(0))
    assert result.std().item() == pytest.approx(0.1, rel=0.02)  # of 49 152 draws: 0.3 %
    assert result.mean().item() == pytest.approx(0.5, abs=0.002)
    full = augmentation(torch.ones(4, 3, 8, 8), noise=0.1, rng=np.random.default_rng(0))
    assert full.max() == 1
