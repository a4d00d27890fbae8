"""Poses of another convention than transforms.json has are told for what they are."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from industnerf.artifacts.views import OPENGL
from industnerf.errors import BadArtifact
from industnerf.geometry.cameras import Cameras, look_at
from industnerf.reconstruct.conventions import likely_mistake
from industnerf.reconstruct.region import region
from tests.reconstruct import scene

CAMERAS = scene.cameras(12)
RIGHT = CAMERAS.c2w @ OPENGL  # as a file should have them
PHOTOS = [Path(f"{i}.png") for i in range(12)]
COLUMNS = np.diag([1.0, -1, -1, 1])  # negates the second and the third
MISTAKES = {  # what the file has, how it is told, and the remedy that is named
    "axes": (RIGHT @ OPENGL, "have OpenCV's axes", lambda file: file @ COLUMNS),
    "inverse": (np.linalg.inv(RIGHT), "are world-to-camera: invert", np.linalg.inv),
    "COLMAP's": (
        np.linalg.inv(RIGHT @ OPENGL),
        "are world-to-camera with OpenCV's axes, as COLMAP's",
        lambda file: np.linalg.inv(file) @ COLUMNS,
    ),
}


def as_read(file):
    return replace(CAMERAS, c2w=file @ OPENGL)


@pytest.mark.parametrize("mistake", MISTAKES)
@pytest.mark.parametrize("given", [None, tuple(scene.CENTRE.tolist())])
def test_a_mistake_is_told_and_its_remedy_helps(mistake, given):
    file, told, remedy = MISTAKES[mistake]
    with pytest.raises(BadArtifact) as refusal:
        region(as_read(file), PHOTOS, given, given and 1.0)
    assert f"it looks as if the matrices {told}" in str(refusal.value)
    assert "--centre X Y Z" not in str(refusal.value)  # which would lead in circles
    centre, _ = region(as_read(remedy(file)), PHOTOS, given, given and 1.0)
    # a few roundings of positions near 10
    np.testing.assert_allclose(centre, scene.CENTRE, rtol=0, atol=1e-12)


def test_a_turntable_world_to_camera_is_told():
    """Read as camera-to-world, all its axes are one: the height of a view is the same in all."""
    angle = np.linspace(0, 2 * np.pi, 12, endpoint=False)
    eyes = np.stack([5 * np.cos(angle), 5 * np.sin(angle), np.full(12, 2.0)], axis=1)
    gl = look_at(eyes, np.zeros(3)) @ OPENGL
    with pytest.raises(BadArtifact, match=r"are parallel to within .* are world-to-camera: inv"):
        region(as_read(np.linalg.inv(gl)), PHOTOS, None, None)


def test_right_cameras_look_like_nothing_else():
    assert likely_mistake(CAMERAS, None) is None
    assert likely_mistake(CAMERAS, scene.CENTRE) is None


def test_a_centre_behind_right_cameras_is_no_mistake_of_theirs():
    """Turned about, all of these would have it in frame."""
    eyes = np.array([[x, y, 9.0] for x in (-2.0, 0, 2) for y in (-2.0, -1, 1, 2)])
    cameras = Cameras(CAMERAS.K, look_at(eyes, np.zeros(3)), scene.WIDTH, scene.HEIGHT)
    with pytest.raises(BadArtifact, match="is it in the frame and the unit of the cameras"):
        region(cameras, PHOTOS, (0.0, 0.0, 30.0), 1.0)


def test_cameras_that_look_anywhere_are_asked_about():
    """Eyes about the part that look along the ring, so that no reading has it in frame."""
    angle = np.linspace(0, 2 * np.pi, 12, endpoint=False)
    eyes = 9 * np.stack([np.cos(angle), np.sin(angle), np.zeros(12)], axis=1)
    along = np.stack([-np.sin(angle), np.cos(angle), 0.2 * np.cos(5 * angle)], axis=1)
    c2w = np.concatenate([look_at(e[None], e + a) for e, a in zip(eyes, along, strict=True)])
    cameras = Cameras(CAMERAS.K, c2w, scene.WIDTH, scene.HEIGHT)
    for given, radius in ((None, None), ((0.0, 0.0, 0.0), 1.0)):
        with pytest.raises(BadArtifact, match=r"are the matrices camera-to-world, with OpenGL's"):
            region(cameras, PHOTOS, given, radius)
