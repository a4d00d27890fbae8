"""Clouds are float32: what that leaves of a part far from the origin."""

import json

import numpy as np
import pytest

from industnerf.errors import BadArtifact
from industnerf.reconstruct.float_precision import MAX_RELATIVE_SPACING, check_float32_precision
from tests.reconstruct import sample_images


@pytest.mark.parametrize("sign", [1, -1])
def test_a_part_far_from_the_origin_is_refused(sign):
    """Between 2^19 and 2^20 float32 has 24 digits of which 20 are before the point: 1/16 apart."""
    check_float32_precision(np.array([0, sign * 6e5, 0.0]), 1.1 / 16 / MAX_RELATIVE_SPACING)
    with pytest.raises(BadArtifact, match=r"6.01e\+05, where .* 0.062 apart, 0.00011 of"):
        check_float32_precision(np.array([0, sign * 6e5, 0.0]), 0.9 / 16 / MAX_RELATIVE_SPACING)


def test_a_part_at_the_origin_may_have_any_size():
    for radius in (1e-9, 1.0, 1e9):
        check_float32_precision(np.zeros(3), radius)


@pytest.mark.parametrize("coordinate", [np.inf, np.nan, 1e39])
def test_nowhere_is_refused(coordinate):
    with pytest.raises(BadArtifact, match="move the origin"):
        check_float32_precision(np.array([coordinate, 0, 0]), 1.0)


def test_the_command_refuses_cameras_far_away(workspace, fake):
    transforms = json.loads(workspace.transforms.read_text())
    for frame in transforms["frames"]:
        frame["transform_matrix"][0][3] += 1e6
    sample_images.write_json_file(workspace.transforms, transforms)
    code, _, errors = workspace.run()
    assert (code, "move the origin of the frame near the part" in errors) == (2, True)
    assert fake.LAST_CALL == {}
