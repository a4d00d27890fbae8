"""Poses of another convention than transforms.json has are told for what they are."""

from dataclasses import replace

import numpy as np
import pytest

from industnerf.artifacts.views import OPENGL
from industnerf.errors import BadArtifact
from industnerf.geometry.cameras import Cameras, look_at
from industnerf.reconstruct.region import detect_convention_error, region_of_interest
from tests.reconstruct import sample_images

CAMERAS = sample_images.cameras(12)
CORRECT_POSES = CAMERAS.c2w @ OPENGL  # as a file should have them
NAMES = [f"{i}.png" for i in range(12)]
FLIP_YZ = np.diag([1.0, -1, -1, 1])  # negates the second and the third
CONVENTION_ERRORS = {  # what the file has, how it is told, and the remedy that is named
    "axes": (CORRECT_POSES @ OPENGL, "have OpenCV's axes", lambda matrices: matrices @ FLIP_YZ),
    "inverse": (np.linalg.inv(CORRECT_POSES), "are world-to-camera: invert", np.linalg.inv),
    "COLMAP's": (
        np.linalg.inv(CORRECT_POSES @ OPENGL),
        "are world-to-camera with OpenCV's axes, as COLMAP's",
        lambda matrices: np.linalg.inv(matrices) @ FLIP_YZ,
    ),
}


def as_loaded(matrices):
    return replace(CAMERAS, c2w=matrices @ OPENGL)


@pytest.mark.parametrize("mistake", CONVENTION_ERRORS)
@pytest.mark.parametrize("given_center", [None, tuple(sample_images.CENTER.tolist())])
def test_a_mistake_is_told_and_its_remedy_helps(mistake, given_center):
    matrices, message, remedy = CONVENTION_ERRORS[mistake]
    with pytest.raises(BadArtifact) as refusal:
        region_of_interest(as_loaded(matrices), NAMES, given_center, given_center and 1.0)
    assert f"it looks as if the matrices {message}" in str(refusal.value)
    assert "--center X Y Z" not in str(refusal.value)  # which would lead in circles
    center, _ = region_of_interest(
        as_loaded(remedy(matrices)), NAMES, given_center, given_center and 1.0
    )
    # a few roundings of positions near 10
    np.testing.assert_allclose(center, sample_images.CENTER, rtol=0, atol=1e-12)


def test_a_turntable_world_to_camera_is_told():
    """Read as camera-to-world, all its axes are one: the height of a view is the same in all."""
    angle = np.linspace(0, 2 * np.pi, 12, endpoint=False)
    eyes = np.stack([5 * np.cos(angle), 5 * np.sin(angle), np.full(12, 2.0)], axis=1)
    gl = look_at(eyes, np.zeros(3)) @ OPENGL
    with pytest.raises(BadArtifact, match=r"are parallel to within .* are world-to-camera: inv"):
        region_of_interest(as_loaded(np.linalg.inv(gl)), NAMES, None, None)


def test_right_cameras_look_like_nothing_else():
    assert detect_convention_error(CAMERAS, None) is None
    assert detect_convention_error(CAMERAS, sample_images.CENTER) is None


def test_a_center_behind_right_cameras_is_no_mistake_of_theirs():
    """Turned about, all of these would have it in frame."""
    eyes = np.array([[x, y, 9.0] for x in (-2.0, 0, 2) for y in (-2.0, -1, 1, 2)])
    cameras = Cameras(
        CAMERAS.K, look_at(eyes, np.zeros(3)), sample_images.WIDTH, sample_images.HEIGHT
    )
    with pytest.raises(BadArtifact, match="is it in the frame and the unit of the cameras"):
        region_of_interest(cameras, NAMES, (0.0, 0.0, 30.0), 1.0)


def test_cameras_that_look_anywhere_are_asked_about():
    """Eyes about the part that look along the ring, so that no reading has it in frame."""
    angle = np.linspace(0, 2 * np.pi, 12, endpoint=False)
    eyes = 9 * np.stack([np.cos(angle), np.sin(angle), np.zeros(12)], axis=1)
    directions = np.stack([-np.sin(angle), np.cos(angle), 0.2 * np.cos(5 * angle)], axis=1)
    c2w = np.concatenate([look_at(e[None], e + a) for e, a in zip(eyes, directions, strict=True)])
    cameras = Cameras(CAMERAS.K, c2w, sample_images.WIDTH, sample_images.HEIGHT)
    for given_center, radius in ((None, None), ((0.0, 0.0, 0.0), 1.0)):
        with pytest.raises(BadArtifact, match=r"are the matrices camera-to-world, with OpenGL's"):
            region_of_interest(cameras, NAMES, given_center, radius)
