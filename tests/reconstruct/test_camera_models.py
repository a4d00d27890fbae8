"""Intrinsics from whatever words a file has for them."""

import math

import numpy as np
import pytest

from industnerf.errors import BadArtifact
from industnerf.reconstruct.camera_models import (
    Distortion,
    image_size,
    intrinsics,
    merge_camera_params,
    parse_distortion,
)

W, H = 640, 480


def K(camera_params):
    return intrinsics(camera_params, W, H, "frame 0")


def test_every_number_has_its_place():
    camera_params = {"fl_x": 500.0, "fl_y": 510, "cx": 321.5, "cy": 200.25}
    assert K(camera_params).tolist() == [[500, 0, 321.5], [0, 510, 200.25], [0, 0, 1]]


def test_an_angle_of_view_is_a_focal_length():
    """The edge of the image is seen under half the angle: tan(a / 2) = (w / 2) / f."""
    camera_params = {
        "camera_angle_x": 2 * math.atan(W / 2 / 500),
        "camera_angle_y": 2 * math.atan(0.5),
    }
    # a few roundings of numbers near 500
    np.testing.assert_allclose(
        K(camera_params), [[500, 0, 320], [0, 480, 240], [0, 0, 1]], rtol=1e-14
    )


def test_pixels_are_square_unless_said_otherwise():
    assert K({"fl_x": 500.0})[1, 1] == 500
    assert K({"camera_angle_x": 1.0})[1, 1] == K({"camera_angle_x": 1.0})[0, 0]


def test_a_focal_length_goes_before_an_angle():
    assert K({"fl_x": 500.0, "camera_angle_x": 0.1})[0, 0] == 500


def test_a_frames_own_words_go_before_the_shared_ones():
    shared = {"fl_x": 500.0, "fl_y": 510.0, "cx": 300.0, "w": W, "aabb_scale": 4}
    assert merge_camera_params(shared, {"fl_x": 400.0, "name": "a"}) == {
        "fl_x": 400.0,
        "cx": 300.0,
        "w": W,
    }
    # in other words, too: else the shared fl_x would win over the frame's angle
    assert "fl_x" not in merge_camera_params(shared, {"camera_angle_x": 1.0})
    assert merge_camera_params(shared, {"cx": 1.0}) == {
        "fl_x": 500.0,
        "fl_y": 510.0,
        "cx": 1.0,
        "w": W,
    }


def test_null_is_as_if_nothing_were_said():
    assert merge_camera_params({"k4": None, "camera_model": None, "fl_x": 5.0}, {"k1": None}) == {
        "fl_x": 5.0
    }
    # a frame that says null has what all have
    assert merge_camera_params({"k4": 0.1, "fl_x": 5.0}, {"k4": None, "fl_y": None}) == {
        "k4": 0.1,
        "fl_x": 5.0,
    }


@pytest.mark.parametrize(
    ("camera_params", "complaint"),
    [
        ({}, "neither fl_x nor camera_angle_x"),
        ({"fl_y": 5.0}, "neither fl_x nor"),
        ({"fl_x": 0}, "fl_x is 0, must be a number above 0"),
        ({"fl_x": "500"}, "fl_x is '500'"),
        ({"fl_x": math.nan}, "fl_x is nan"),
        ({"fl_x": math.inf}, "fl_x is inf"),
        ({"fl_x": True}, "fl_x is True"),
        ({"fl_x": 10**400}, "fl_x is 10000"),
        ({"camera_angle_x": 50.0}, "must be radians above 0 and below pi"),
        ({"camera_angle_x": 5e-324}, "must be radians above 0 and below pi"),
        ({"fl_x": 5.0, "cx": 640.0}, "principal point (640, 240) is outside the image of 640 x"),
    ],
)
def test_what_is_no_lens_is_refused(camera_params, complaint):
    with pytest.raises(BadArtifact) as refusal:
        K(camera_params)
    assert str(refusal.value).startswith("frame 0: ")
    assert complaint in str(refusal.value)


@pytest.mark.parametrize(
    "camera_params",
    [
        {"k4": 1.0},
        {"k4": [1, [2]]},
        {"k4": [0, [0]]},
        {"k4": 10**400},
        {"k4": "0"},
        {"camera_model": ["OPENCV"]},
        {"distortion_params": [0, 0, 0.1]},
        {"camera_model": "OPENCV_FISHEYE", "k1": 0.1},
        {"is_fisheye": True},
        {"camera_model": "EQUIRECTANGULAR"},
    ],
)
def test_a_lens_of_another_model_is_refused(camera_params):
    with pytest.raises(BadArtifact, match=r"frame 0: .* undistort the photographs first"):
        parse_distortion(camera_params, "frame 0")


def test_a_fisheye_is_called_one():
    with pytest.raises(BadArtifact, match=r"frame 0: is_fisheye: such lenses are not known"):
        parse_distortion({"is_fisheye": True}, "frame 0")


def test_how_a_lens_bends_lines_is_read():
    camera_params = {
        "camera_model": "OPENCV",
        "k1": 0.01,
        "k2": -2e-3,
        "p1": 0,
        "p2": -1e-4,
        "k4": 0.0,
    }
    assert parse_distortion(camera_params, "frame 0") == Distortion(k1=0.01, k2=-2e-3, p2=-1e-4)
    assert parse_distortion({"camera_model": "SIMPLE_RADIAL", "k1": 1}, "frame 0") == Distortion(
        k1=1.0
    )
    assert parse_distortion({"camera_model": "opencv", "k1": 1}, "frame 0") == Distortion(k1=1.0)


@pytest.mark.parametrize(
    "value", ["0.1", None, True, math.nan, pytest.param(10**400, id="400 digits"), [1, [2]]]
)
def test_a_coefficient_that_is_no_number_is_refused(value):
    with pytest.raises(BadArtifact, match=r"frame 0: k1 is .*, must be a number"):
        parse_distortion({"k1": value}, "frame 0")


def test_a_distortion_of_nothing_is_none():
    zeros = dict.fromkeys(["k1", "k2", "k3", "k4", "p1", "p2"], 0.0)
    assert (
        parse_distortion(zeros | {"camera_model": "OPENCV", "is_fisheye": False}, "frame 0") is None
    )


def test_the_size_is_stated_whole_or_not_at_all():
    assert image_size({}, "frame 0") is None
    assert image_size({"w": 640.0, "h": 480}, "frame 0") == (640, 480)
    with pytest.raises(BadArtifact, match="frame 0: h is None"):
        image_size({"w": 640}, "frame 0")


@pytest.mark.parametrize("width", [0.5, 512.9])
def test_a_part_of_a_pixel_is_no_size(width):
    with pytest.raises(BadArtifact, match=rf"frame 0: w is {width}, must be a whole number of at"):
        image_size({"w": width, "h": 480}, "frame 0")
