"""Matrices of transforms.json: what is a camera, what is rounding, and what is neither."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from industnerf.artifacts.views import OPENGL
from industnerf.errors import BadArtifact
from industnerf.reconstruct.poses import MAX_ORTHOGONALITY_ERROR, parse_pose


def random_pose(seed=0, scale=1.0):
    rng = np.random.default_rng(seed)
    c2w = np.eye(4)
    c2w[:3, :3] = scale * Rotation.random(rng=rng).as_matrix()
    c2w[:3, 3] = rng.uniform(-1e3, 1e3, 3)
    return c2w


def load(c2w):
    return parse_pose(np.asarray(c2w).tolist(), "frame 2 (a.png)")


@given(st.integers(0, 1000), st.floats(1e-3, 1e3))
def test_a_scale_of_the_axes_is_dropped_and_told(seed, scale):
    truth, (c2w, found_scale) = random_pose(seed), load(random_pose(seed, scale))
    # a few roundings of numbers up to 1 in a 3 x 3 decomposition; positions are not touched
    np.testing.assert_allclose(c2w[:3, :3], (truth @ OPENGL)[:3, :3], rtol=0, atol=1e-14)
    np.testing.assert_array_equal(c2w[:3, 3], truth[:3, 3])
    assert found_scale == pytest.approx(scale, rel=1e-14)


def test_axes_turn_from_opengl_to_opencv():
    """An OpenGL camera looks along its -z with +y up; ours along +z with +y down."""
    c2w, _ = load(np.eye(4))
    np.testing.assert_array_equal(c2w @ [0, 0, 1, 0], [0, 0, -1, 0])
    np.testing.assert_array_equal(c2w @ [0, 1, 0, 0], [0, -1, 0, 0])
    np.testing.assert_array_equal(c2w @ [1, 0, 0, 0], [1, 0, 0, 0])


@pytest.mark.parametrize("digits", [4, 6])
def test_rounded_files_give_rotations_all_the_same(digits):
    c2w, _ = load(random_pose(1).round(digits))
    axes = c2w[:3, :3]
    np.testing.assert_allclose(axes.T @ axes, np.eye(3), rtol=0, atol=1e-14)  # float64 rounding
    # the nearest rotation is no further than the rounded matrix, 3 columns x 3 roundings off
    np.testing.assert_allclose(
        axes, (random_pose(1) @ OPENGL)[:3, :3], rtol=0, atol=3 * 10.0**-digits
    )


def test_a_skewed_matrix_is_refused_with_how_much():
    c2w = np.eye(4)
    c2w[0, 1] = 0.05  # R^T R has this off its diagonal, and the determinant stays 1
    with pytest.raises(BadArtifact, match=r"frame 2 \(a.png\): .* no rotation: off by 0.05, at"):
        load(c2w)
    c2w[0, 1] = 0.9 * MAX_ORTHOGONALITY_ERROR
    load(c2w)


def test_a_stretched_matrix_is_refused():
    with pytest.raises(BadArtifact, match="no rotation"):
        load(np.diag([1.0, 1.0, 1.01, 1.0]))


@pytest.mark.parametrize(
    ("wrong", "complaint"),
    [
        (np.diag([1.0, 1, -1, 1]), "mirrors space"),
        (np.diag([1.0, 1, 0, 1]), "is flat"),
        (np.eye(3), r"shape \(3, 3\), must be \(4, 4\)"),
        (np.diag([1, 1, np.nan, 1]), "not finite"),
        (np.eye(4).T[::-1], "the last row"),
        (np.array([["a"] * 4] * 4), "no matrix of numbers"),
        (np.eye(4) * 2, "the last row"),
    ],
)
def test_what_is_no_camera_is_refused(wrong, complaint):
    with pytest.raises(BadArtifact, match=rf"^frame 2 \(a.png\): .*{complaint}"):
        load(wrong)


def test_a_ragged_matrix_is_refused():
    with pytest.raises(BadArtifact, match="no matrix of numbers"):
        parse_pose([[1, 0], [0]], "frame 0")


@pytest.mark.parametrize("sign", [1, -1])
def test_a_number_of_400_digits_is_refused(sign):
    matrix = np.eye(4).tolist()
    matrix[1][3] = sign * 10**400
    with pytest.raises(BadArtifact, match="frame 0: a number of transform_matrix is above 1e308"):
        parse_pose(matrix, "frame 0")
