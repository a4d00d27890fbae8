"""The region of interest: what all cameras look at, or what the user says."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from industnerf.errors import BadArtifact, BadParams
from industnerf.geometry.cameras import Cameras, common_view_ball, look_at
from industnerf.reconstruct.region import region_of_interest
from tests.reconstruct import sample_images

CAMERAS = sample_images.cameras()
NAMES = [f"{i}.png" for i in range(9)]


def looking_at(eyes, targets):
    c2w = np.concatenate(
        [look_at(eye[None], target) for eye, target in zip(eyes, targets, strict=True)]
    )
    return Cameras(
        np.tile(CAMERAS.K[0], (len(c2w), 1, 1)), c2w, sample_images.WIDTH, sample_images.HEIGHT
    )


def ring_positions(count=6):
    angle = np.linspace(0, 2 * np.pi, count, endpoint=False)
    return np.stack([np.cos(angle), np.sin(angle), np.zeros(count)], axis=1)


def test_cameras_frame_what_they_look_at():
    center, radius = region_of_interest(CAMERAS, NAMES, None, None)
    # axes of unit length and positions near 10 meet to rounding
    np.testing.assert_allclose(center, sample_images.CENTER, rtol=0, atol=1e-12)
    # 7 away, the short side is 32 px at a focal length of 62
    assert radius == pytest.approx(7 * np.sin(np.arctan(16 / 62)), rel=1e-12)


def test_the_ball_moves_and_grows_with_the_cameras_frame():
    """The unit and the frame are the user's: a similarity of the cameras is one of the ball."""
    rotation, scale, shift = Rotation.random(rng=1).as_matrix(), 1e-3, np.array([5.0, 6, 7])
    c2w = CAMERAS.c2w.copy()
    c2w[:, :3, :3] = rotation @ c2w[:, :3, :3]
    c2w[:, :3, 3] = scale * c2w[:, :3, 3] @ rotation.T + shift
    moved = Cameras(CAMERAS.K, c2w, sample_images.WIDTH, sample_images.HEIGHT)
    center, radius = region_of_interest(moved, NAMES, None, None)
    original_center, original_radius = region_of_interest(CAMERAS, NAMES, None, None)
    np.testing.assert_allclose(
        center, scale * rotation @ original_center + shift, rtol=0, atol=1e-12
    )
    assert radius == pytest.approx(scale * original_radius, rel=1e-10)


def test_what_is_given_is_taken():
    center, radius = region_of_interest(CAMERAS, NAMES, (10.5, -4.0, 3.0), 0.25)
    assert (center.tolist(), radius) == ([10.5, -4.0, 3.0], 0.25)
    center, radius = region_of_interest(CAMERAS, NAMES, None, 0.25)
    np.testing.assert_array_equal(center, common_view_ball(CAMERAS)[0])
    assert radius == 0.25


def test_a_center_needs_a_radius():
    with pytest.raises(BadParams, match="--center needs --radius"):
        region_of_interest(CAMERAS, NAMES, (0.0, 0.0, 0.0), None)


def test_a_given_center_must_be_in_frame():
    with pytest.raises(BadArtifact, match="0 of 5 cameras have the given --center in frame"):
        region_of_interest(CAMERAS, NAMES, (1e4, 0.0, 0.0), 1.0)


@pytest.mark.parametrize(
    "cameras",
    [
        looking_at(
            ring_positions(), ring_positions() + np.array([0, 1e-9, 3])
        ),  # all upwards: a copy stand
        looking_at(np.array([[5.0, 0, 0], [-5.0, 0, 0]]), np.zeros((2, 3))),  # face to face
        looking_at(
            ring_positions(), np.tile([0, 0, 100.0], (6, 1))
        ),  # 0.6 degrees: far away, anywhere
        looking_at(
            100 * ring_positions(), 100 * ring_positions() + np.array([0.01, 0, 1])
        ),  # a little askew
    ],
)
def test_parallel_cameras_meet_nowhere(cameras):
    with pytest.raises(BadArtifact, match=r"do not look at a common point: .*--center X Y Z"):
        region_of_interest(cameras, NAMES, None, None)


def test_two_views_at_an_angle_are_enough():
    cameras = looking_at(np.array([[5.0, 0, 0], [5.0, 1, 0]]), np.zeros((2, 3)))
    # 11 degrees apart, so rounding of positions near 5 grows tenfold or so
    np.testing.assert_allclose(region_of_interest(cameras, NAMES, None, None)[0], 0, atol=1e-12)


def test_cameras_that_look_outwards_are_refused():
    with pytest.raises(BadArtifact, match=r"6 of 6, the first that of .*0.png"):
        region_of_interest(looking_at(ring_positions(), 2 * ring_positions()), NAMES, None, None)


def test_a_camera_that_looks_away_is_named():
    targets = np.zeros((6, 3))
    targets[4] = [0, -30, 4]
    with pytest.raises(BadArtifact, match=r"1 of 6 cameras .*that of .*4.png"):
        region_of_interest(looking_at(5 * ring_positions(), targets), NAMES, None, None)


def test_hands_may_shake():
    """Aims that scatter by a tenth of the distance still have a common point in frame."""
    aims = np.random.default_rng(0).normal(0, 0.2, (6, 3))
    center, _ = region_of_interest(looking_at(5 * ring_positions(), aims), NAMES, None, None)
    assert np.linalg.norm(center) < 0.5  # of a mean of six aims 0.35 off each


def test_a_region_that_a_camera_is_in_is_refused():
    """Such as one in mm about cameras in m."""
    cameras = looking_at(5 * ring_positions(), np.zeros((6, 3)))
    with pytest.raises(BadArtifact, match="has a radius of 50, and a camera is 5 from its center"):
        region_of_interest(cameras, NAMES, None, 50.0)
