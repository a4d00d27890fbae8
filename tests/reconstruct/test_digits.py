"""Clouds are float32: what that leaves of a part far from the origin."""

import json

import numpy as np
import pytest

from industnerf.errors import BadArtifact
from industnerf.reconstruct.digits import FINEST, check_digits
from tests.reconstruct import scene


@pytest.mark.parametrize("sign", [1, -1])
def test_a_part_far_from_the_origin_is_refused(sign):
    """Between 2^19 and 2^20 float32 has 24 digits of which 20 are before the point: 1/16 apart."""
    check_digits(np.array([0, sign * 6e5, 0.0]), 1.1 / 16 / FINEST)
    with pytest.raises(BadArtifact, match=r"6.01e\+05, where .* 0.062 apart, 0.00011 of"):
        check_digits(np.array([0, sign * 6e5, 0.0]), 0.9 / 16 / FINEST)


def test_a_part_at_the_origin_may_have_any_size():
    for radius in (1e-9, 1.0, 1e9):
        check_digits(np.zeros(3), radius)


@pytest.mark.parametrize("place", [np.inf, np.nan, 1e39])
def test_nowhere_is_refused(place):
    with pytest.raises(BadArtifact, match="move the origin"):
        check_digits(np.array([place, 0, 0]), 1.0)


def test_the_command_refuses_cameras_far_away(desk, fake):
    said = json.loads(desk.transforms.read_text())
    for frame in said["frames"]:
        frame["transform_matrix"][0][3] += 1e6
    scene.rewrite(desk.transforms, said)
    code, _, errors = desk.run()
    assert (code, "move the origin of the frame near the part" in errors) == (2, True)
    assert fake.SEEN == {}
