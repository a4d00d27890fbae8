"""PosE in its readings: closed forms, rank, and the spacing that it can be asked for."""

import math

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from industnerf.errors import BadParams
from industnerf.methods.industnerf.position_encoding import (
    encode_positions,
    encoding_channels,
    encoding_coordinates,
)

SEEDS = st.integers(0, 2**32 - 1)
READINGS = ["intended", "printed", "nerf"]


def points(seed: int, count: int = 50) -> torch.Tensor:
    generator = torch.Generator().manual_seed(seed)
    return torch.rand(count, 3, dtype=torch.float64, generator=generator) * 2 - 1


def phase(x: float, j: int, channels: int, a: float, b: float, reading: str) -> float:
    """Of one coordinate and one j, as eqs. (2) and (3) are read."""
    return {
        "intended": a * x / b ** (6 * j / channels),
        "printed": a * x + b * 6 * j / channels,
        "nerf": 2**j * math.pi * x,
    }[reading]


@pytest.mark.parametrize("reading", READINGS)
@given(SEEDS, st.sampled_from([6, 12, 30]), st.floats(1, 100), st.floats(1.5, 1000))
def test_channels_are_sine_and_cosine_of_one_phase_axis_after_axis(reading, seed, c, a, b):
    x = points(seed, 4)
    slow = [
        [
            wave(phase(float(value), j, c, a, b, reading))
            for value in point
            for j in range(c // 6)
            for wave in (math.sin, math.cos)
        ]
        for point in x
    ]
    # Phases reach 100 + 1000 and are rounded by 1e-16 of that, a few times over.
    actual = encode_positions(x, c, a, b, reading)
    torch.testing.assert_close(actual, torch.tensor(slow, dtype=torch.float64), rtol=0, atol=1e-11)


@pytest.mark.parametrize("channels", [12, 24, 60])
def test_the_printed_form_has_rank_six(channels):
    """All of an axis's channels lie in the span of sin(a x) and cos(a x)."""
    assert (
        torch.linalg.matrix_rank(encode_positions(points(0, 200), channels, 7.0, 3.0, "printed"))
        == 6
    )


@pytest.mark.parametrize("reading", ["intended", "nerf"])
def test_the_other_forms_have_full_rank(reading):
    """24 channels of 8 frequencies; base 8 keeps the slowest at a whole wave over [-1, 1]."""
    assert torch.linalg.matrix_rank(encode_positions(points(0, 200), 24, 20.0, 8.0, reading)) == 24


def test_beyond_the_alias_bound_fast_waves_look_slow():
    """Spacing h: sines of magnitude pi/h + d and pi/h - d differ in sign only, on the grid."""
    h, d = 2 / 31, 5.0
    grid = (torch.arange(32, dtype=torch.float64) * h)[:, None].expand(32, 3)
    fast = encode_positions(grid, 6, math.pi / h + d, 1000.0, "intended")
    slow = encode_positions(grid, 6, math.pi / h - d, 1000.0, "intended")
    torch.testing.assert_close(fast[:, ::2], -slow[:, ::2], rtol=0, atol=1e-12)
    torch.testing.assert_close(fast[:, 1::2], slow[:, 1::2], rtol=0, atol=1e-12)


def test_the_first_wave_is_two_pi_over_magnitude_long():
    x = points(1)
    again = encode_positions(x + 2 * math.pi / 50, 36, 50.0, 1000.0, "intended")
    here = encode_positions(x, 36, 50.0, 1000.0, "intended")
    first = [0, 1, 12, 13, 24, 25]  # j = 0 of each axis
    torch.testing.assert_close(again[:, first], here[:, first], rtol=0, atol=1e-12)
    assert (again[:, 2:12] - here[:, 2:12]).abs().max() > 0.5


def test_identity_returns_the_coordinates():
    x = points(2)
    assert encode_positions(x, 7, 1.0, 1.0, "identity") is x


@pytest.mark.parametrize("reading", [*READINGS, "identity"])
@pytest.mark.parametrize("dtype", [torch.float32, torch.float64])
def test_columns_and_type_are_as_said(reading, dtype):
    actual = encode_positions(points(3).to(dtype), 18, 5.0, 10.0, reading)
    assert actual.shape == (50, encoding_channels(18, reading))
    assert actual.dtype == dtype


@pytest.mark.parametrize("channels", [-6, 0, 3, 8, 37])
def test_channels_that_are_no_multiple_of_six_are_refused(channels):
    with pytest.raises(BadParams, match=f"PosE of {channels} channels"):
        encode_positions(points(0), channels, 1.0, 2.0, "intended")


@pytest.mark.parametrize("reading", READINGS)
def test_gradients_are_right(reading):
    x = points(4, 3).requires_grad_()
    assert torch.autograd.gradcheck(lambda x: encode_positions(x, 12, 3.0, 5.0, reading), x)


def test_frames_are_camera_world_or_the_cameras_place():
    x, c2w = points(5), torch.eye(4, dtype=torch.float64)
    c2w[:3] = torch.tensor([[0.0, 0, 1, 4], [1, 0, 0, 5], [0, 1, 0, 6]])  # camera z is world x
    assert encoding_coordinates(x, c2w, "world") is x
    moved = x - torch.tensor([4.0, 5, 6])
    torch.testing.assert_close(encoding_coordinates(x, c2w, "camera"), moved[:, [1, 2, 0]])
    center = torch.tensor([[4.0, 5, 6]], dtype=torch.float64).repeat(50, 1)
    torch.testing.assert_close(
        encoding_coordinates(x, c2w, "camera_center"), center, rtol=0, atol=0
    )
