"""One wrong pose of many is named, with a remedy that can be pasted."""

import re
import shlex
from dataclasses import replace

import numpy as np
import pytest

from industnerf.errors import BadArtifact
from industnerf.geometry.cameras import common_view_ball, look_at
from industnerf.reconstruct.pose_outliers import odd_cameras
from industnerf.reconstruct.region import region_of_interest
from tests.reconstruct import sample_images

COUNT = 14
CAMERAS = sample_images.cameras(COUNT)
NAMES = [f"my images/{i:03d}.png" for i in range(COUNT)]
HALF_TURN = np.diag([-1.0, 1, -1, 1])


def turned_away(indices, how):
    c2w = CAMERAS.c2w.copy()
    for i in indices:
        if how == "backwards":
            c2w[i] = c2w[i] @ HALF_TURN
        elif how == "aside":
            aim = c2w[i, :3, 3] + np.array([3.0, 9, -2])
            c2w[i] = look_at(c2w[i : i + 1, :3, 3].copy(), aim)[0]
        else:
            c2w[i, :3, 3] = [80.0, 300, 10]
    return replace(CAMERAS, c2w=c2w)


@pytest.mark.parametrize("how", ["backwards", "aside", "far"])
@pytest.mark.parametrize("wrong", [[5], [0, 9], [1, 2, 13]])
def test_wrong_poses_are_named_and_the_remedies_help(how, wrong):
    cameras = turned_away(wrong, how)
    assert odd_cameras(cameras) == wrong
    with pytest.raises(BadArtifact) as refusal:
        region_of_interest(cameras, NAMES, None, None)
    message = str(refusal.value)
    assert message.startswith(f"{len(wrong)} of {COUNT} cameras look elsewhere than all others")
    excluded = shlex.split(re.search(r"--exclude (.*?); or", message)[1])
    assert excluded == [NAMES[i] for i in wrong]
    kept = cameras[np.setdiff1d(np.arange(COUNT), wrong)]
    expected_center, expected_radius = common_view_ball(kept)
    numbers = re.search(r"--center (\S+ \S+ \S+) --radius (\S+)", message)
    center = tuple(float(x) for x in numbers[1].split())
    np.testing.assert_allclose(center, expected_center, atol=1e-5)
    assert float(numbers[2]) == pytest.approx(expected_radius, rel=1e-5)
    region_of_interest(cameras, NAMES, center, float(numbers[2]))


def test_no_digits_of_rounding_are_printed():
    shifted = replace(
        CAMERAS, c2w=CAMERAS.c2w - np.pad(sample_images.CENTER[:, None], ((0, 1), (3, 0)))
    )
    c2w = shifted.c2w.copy()
    c2w[5] = c2w[5] @ HALF_TURN
    with pytest.raises(BadArtifact, match=r"--center 0 0 0 --radius"):
        region_of_interest(replace(shifted, c2w=c2w), NAMES, None, None)


def test_more_than_a_quarter_is_no_matter_of_a_few():
    assert odd_cameras(turned_away([0, 2, 4, 6, 8], "aside")) == []
