"""The region of interest: what all cameras look at, or what the user says."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from industnerf.errors import BadArtifact, BadParams
from industnerf.geometry.cameras import Cameras, framed_ball, look_at
from industnerf.reconstruct.region import region
from tests.reconstruct import scene

CAMERAS = scene.cameras()
PHOTOS = [f"{i}.png" for i in range(9)]


@pytest.fixture
def photos(tmp_path):
    return [tmp_path / name for name in PHOTOS]


def standing(eyes, targets):
    c2w = np.concatenate(
        [look_at(eye[None], target) for eye, target in zip(eyes, targets, strict=True)]
    )
    return Cameras(np.tile(CAMERAS.K[0], (len(c2w), 1, 1)), c2w, scene.WIDTH, scene.HEIGHT)


def ring(count=6):
    angle = np.linspace(0, 2 * np.pi, count, endpoint=False)
    return np.stack([np.cos(angle), np.sin(angle), np.zeros(count)], axis=1)


def test_cameras_frame_what_they_look_at(photos):
    centre, radius = region(CAMERAS, photos, None, None)
    # axes of unit length and positions near 10 meet to rounding
    np.testing.assert_allclose(centre, scene.CENTRE, rtol=0, atol=1e-12)
    # 7 away, the short side is 32 px at a focal length of 62
    assert radius == pytest.approx(7 * np.sin(np.arctan(16 / 62)), rel=1e-12)


def test_the_ball_moves_and_grows_with_the_cameras_frame(photos):
    """The unit and the frame are the user's: a similarity of the cameras is one of the ball."""
    turn, scale, shift = Rotation.random(rng=1).as_matrix(), 1e-3, np.array([5.0, 6, 7])
    c2w = CAMERAS.c2w.copy()
    c2w[:, :3, :3] = turn @ c2w[:, :3, :3]
    c2w[:, :3, 3] = scale * c2w[:, :3, 3] @ turn.T + shift
    moved = Cameras(CAMERAS.K, c2w, scene.WIDTH, scene.HEIGHT)
    centre, radius = region(moved, photos, None, None)
    before, size = region(CAMERAS, photos, None, None)
    np.testing.assert_allclose(centre, scale * turn @ before + shift, rtol=0, atol=1e-12)
    assert radius == pytest.approx(scale * size, rel=1e-10)


def test_what_is_given_is_taken(photos):
    centre, radius = region(CAMERAS, photos, (10.5, -4.0, 3.0), 0.25)
    assert (centre.tolist(), radius) == ([10.5, -4.0, 3.0], 0.25)
    centre, radius = region(CAMERAS, photos, None, 0.25)
    np.testing.assert_array_equal(centre, framed_ball(CAMERAS)[0])
    assert radius == 0.25


def test_a_centre_needs_a_radius(photos):
    with pytest.raises(BadParams, match="--centre needs --radius"):
        region(CAMERAS, photos, (0.0, 0.0, 0.0), None)


def test_a_given_centre_must_be_in_frame(photos):
    with pytest.raises(BadArtifact, match="0 of 5 cameras have the given --centre in frame"):
        region(CAMERAS, photos, (1e4, 0.0, 0.0), 1.0)


@pytest.mark.parametrize(
    "cameras",
    [
        standing(ring(), ring() + np.array([0, 1e-9, 3])),  # all upwards: a copy stand
        standing(np.array([[5.0, 0, 0], [-5.0, 0, 0]]), np.zeros((2, 3))),  # face to face
        standing(ring(), np.tile([0, 0, 100.0], (6, 1))),  # 0.6 degrees: far away, anywhere
        standing(100 * ring(), 100 * ring() + np.array([0.01, 0, 1])),  # a little askew
    ],
)
def test_parallel_cameras_meet_nowhere(photos, cameras):
    with pytest.raises(BadArtifact, match=r"do not look at a common point: .*--centre X Y Z"):
        region(cameras, photos, None, None)


def test_two_views_at_an_angle_are_enough(photos):
    cameras = standing(np.array([[5.0, 0, 0], [5.0, 1, 0]]), np.zeros((2, 3)))
    # 11 degrees apart, so rounding of positions near 5 grows tenfold or so
    np.testing.assert_allclose(region(cameras, photos, None, None)[0], 0, atol=1e-12)


def test_cameras_that_look_outwards_are_refused(photos):
    with pytest.raises(BadArtifact, match=r"6 of 6, the first that of .*0.png"):
        region(standing(ring(), 2 * ring()), photos, None, None)


def test_a_camera_that_looks_away_is_named(photos):
    targets = np.zeros((6, 3))
    targets[4] = [0, -30, 4]
    with pytest.raises(BadArtifact, match=r"1 of 6, the first that of .*4.png"):
        region(standing(5 * ring(), targets), photos, None, None)


def test_hands_may_shake(photos):
    """Aims that scatter by a tenth of the distance still have a common point in frame."""
    aims = np.random.default_rng(0).normal(0, 0.2, (6, 3))
    centre, _ = region(standing(5 * ring(), aims), photos, None, None)
    assert np.linalg.norm(centre) < 0.5  # of a mean of six aims 0.35 off each


def test_a_region_that_a_camera_is_in_is_refused(photos):
    """Such as one in mm about cameras in m."""
    cameras = standing(5 * ring(), np.zeros((6, 3)))
    with pytest.raises(BadArtifact, match="has a radius of 50, and a camera is 5 from its centre"):
        region(cameras, photos, None, 50.0)
