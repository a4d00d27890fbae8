"""Marching cubes against solids whose surface is known."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from industnerf.geometry.isosurface import isosurface, isosurface_points, volume_matched_level

LO, SPACING = np.array([-1.1, -1.2, -1.3]), 0.05


def lattice(shape=(45, 49, 53)):
    return LO + SPACING * np.moveaxis(np.indices(shape), 0, -1)


def volume(vertices, faces):
    """By Gauss: positive if faces look outwards."""
    a, b, c = np.moveaxis(vertices[faces], 1, 0)
    return np.einsum("ni,ni->", a, np.cross(b, c)) / 6


def test_the_surface_of_a_ball_is_where_it_is_and_looks_outwards():
    radius = 0.8
    values = radius - np.linalg.norm(lattice(), axis=-1)
    vertices, faces = isosurface(values, 0.0, LO, SPACING)
    # A chord of one step's length d sags d^2 / 8r = 4e-4.
    np.testing.assert_allclose(np.linalg.norm(vertices, axis=1), radius, atol=5e-4)
    assert volume(vertices, faces) == pytest.approx(4 / 3 * np.pi * radius**3, rel=5e-3)


def test_points_are_spread_by_area():
    values = np.minimum(*np.moveaxis(np.abs(lattice()[..., :2]) * -1 + [0.6, 0.3], -1, 0))
    values = np.minimum(values, 0.9 - np.abs(lattice()[..., 2]))
    points = isosurface_points(values, 0.0, LO, SPACING, 20000, np.random.default_rng(1))
    x, y, z = np.abs(points).T
    # Away from the edges, which are cut off over one step: 4 sigma of 2000 draws is 9 %.
    faces = [((x > 0.55) & (y < 0.2) & (z < 0.8)).sum(), ((y > 0.25) & (x < 0.5) & (z < 0.8)).sum()]
    assert faces[0] / faces[1] == pytest.approx(0.2 / 0.5, rel=0.09)
    assert len(points) == 20000


def test_a_full_lattice_is_closed_half_a_step_outside():
    vertices, faces = isosurface(np.ones((3, 4, 5)), 0.5, np.zeros(3), 2.0)
    np.testing.assert_allclose(vertices.min(axis=0), -1.0)
    np.testing.assert_allclose(vertices.max(axis=0), [5.0, 7.0, 9.0])
    # A box of 6 x 8 x 10, less its edges: 2 mm cut at 45 degrees.
    assert 0.85 * 480 < volume(vertices, faces) < 480


def test_nothing_inside_gives_no_point():
    rng = np.random.default_rng(0)
    assert len(isosurface_points(np.zeros((4, 4, 4)), 0.5, LO, 1.0, 10, rng)) == 0


def test_above_the_matched_level_lies_the_expected_volume_of_a_ramp():
    """A ramp from 0 to 2 m has the mean m, which is above the share 1 - m of all values."""
    for mean in (0.05, 0.3, 0.5):
        values = np.linspace(0, 2 * mean, 12**3).reshape(12, 12, 12)
        assert volume_matched_level(values) == pytest.approx(2 * mean * (1 - mean), rel=1e-3)


@given(st.integers(0, 2**32 - 1), st.floats(0.02, 20.0))
def test_above_the_matched_level_lies_the_expected_volume(seed, power):
    """To within a cell, however few cells are likely to be full."""
    values = np.random.default_rng(seed).random((7, 8, 9)) ** power
    assert abs((values > volume_matched_level(values)).sum() - values.sum()) <= 1


PROBABILITIES = arrays.arrays(
    np.float32,
    st.tuples(*3 * [st.integers(2, 4)]),
    elements=st.sampled_from([np.float32(x) for x in (0, 1e-6, 0.1, 0.5, 0.75, 1)]),
)


@given(PROBABILITIES)
def test_no_field_but_a_constant_one_is_empty_at_the_matched_level(values):
    """Though many cells may be as likely as the likeliest."""
    assume(np.ptp(values) > 0)
    level = volume_matched_level(values)
    assert values.min() <= level < values.max()
    assert len(isosurface(values, level, LO, SPACING)[1])
