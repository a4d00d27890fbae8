"""From the probability of voxels to points: in place, of one answer, and with a clear refusal."""

from dataclasses import replace

import numpy as np
import pytest
import torch

from industnerf.artifacts.state import ModelState
from industnerf.config import load_params
from industnerf.errors import ReconstructionFailed
from industnerf.geometry.bounding_cube import BoundingCube
from industnerf.geometry.cameras import Cameras
from industnerf.geometry.sphere import fibonacci_sphere
from industnerf.methods.base import Input, MethodInputs
from industnerf.methods.r2n2 import METHODS, predict
from industnerf.methods.r2n2.network import new_net

FRAME = BoundingCube(np.array([10.0, -20.0, 5.0]), 8.0)
CENTERS = (np.arange(32) + 0.5) / 32 - 0.5


@pytest.fixture
def state(settings):
    """A net that was not trained."""
    net = new_net(settings.image_px, settings.channel_divisor, 0)
    return ModelState(
        {name: tensor.numpy() for name, tensor in net.state_dict().items()}, num_parts=1
    )


@pytest.fixture
def inputs():
    """Seven views from places in a row, each brighter by 5 than the one before."""
    return inputs_from(np.arange(7)[:, None] * np.array([1.0, 0, 0]))


def inputs_from(camera_centers):
    c2w = np.tile(np.eye(4), (len(camera_centers), 1, 1))
    c2w[:, :3, 3] = camera_centers
    cameras = Cameras(np.tile(np.eye(3), (len(camera_centers), 1, 1)), c2w, 32, 32)
    level = 5 * np.arange(len(camera_centers), dtype=np.uint8)
    rgb = np.broadcast_to(level[:, None, None, None], (len(camera_centers), 32, 32, 3))
    background = np.ones((len(camera_centers), 3))
    loaded = {Input.RGB: rgb, Input.BACKGROUND: background, Input.PART_FRAME: FRAME}
    return MethodInputs("r2n2", cameras, cameras[:0], loaded)


@pytest.fixture
def predicted_points(monkeypatch, inputs, settings, state):
    """`points(probabilities)`: the surface of these probabilities, in the unit cube."""

    def predicted_points(probabilities):
        monkeypatch.setattr(
            predict, "occupancy_probabilities", lambda *_: probabilities.astype(np.float32)
        )
        result = METHODS["r2n2"].reconstruct(inputs, settings, state, 0)
        assert not result.extra_clouds_mm
        return FRAME.to_unit(result.points_mm)

    return predicted_points


def test_a_plane_encloses_the_volume_that_is_expected(predicted_points):
    # 0.6 of the cube in the mean, and so the part reaches up to x = 0.1
    probabilities = np.broadcast_to((0.6 - 0.5 * CENTERS)[:, None, None], (32, 32, 32))
    result = predicted_points(probabilities)
    assert result.shape == (500, 3)
    # the rest of the surface is the wall of the cube, half a voxel outside of the last centers
    on_plane = (np.abs(result[:, 1:]) < CENTERS[-1]).all(axis=1) & (result[:, 0] > -0.4)
    assert on_plane.sum() > 50
    # a whole layer of voxels is as likely: the plane is at its centers
    assert np.ptp(result[on_plane, 0]) < 1e-5
    np.testing.assert_allclose(result[on_plane, 0], 0.1, atol=0.5 / 32)


def test_a_ball_encloses_the_volume_that_is_expected_by_points_uniform_by_area(predicted_points):
    r = np.linalg.norm(np.stack(np.meshgrid(CENTERS, CENTERS, CENTERS)), axis=0)
    # From 1 at 0.25 to 0 at 0.35: the mean volume is that of r^3 = 0.3^3 + 0.3 * 0.05^2.
    result = predicted_points(np.clip(0.5 + (0.3 - r) / 0.1, 0, 1))
    radius = (0.3**3 + 0.3 * 0.05**2) ** (1 / 3)
    # On a lattice of h = 1/32 linear interpolation of the radius between centers is off by
    # h^2 / 8 r, and faces with edges of up to sqrt(3) h sag by 3 h^2 / 8 r; some 400 voxels are
    # counted as in or out that are cut: 4 deviations of 20 of them are 80 / 32^3 / (4 pi r^2).
    atol = 4 / 32**2 / 8 / 0.3 + 80 / 32**3 / (4 * np.pi * radius**2)
    np.testing.assert_allclose(np.linalg.norm(result, axis=1), radius, atol=atol)
    # Each coordinate of a uniform sphere is uniform: variance r^2 / 3, to 4 / sqrt(500) of it
    np.testing.assert_allclose(result.var(axis=0), radius**2 / 3, rtol=0.18)


def test_a_thin_plate_of_which_little_is_sure_is_there(predicted_points):
    """At no voxel the probability is more than 0.2."""
    probabilities = np.full((32, 32, 32), 1e-4)
    probabilities[:, 15:17] = 0.2
    result = predicted_points(probabilities)
    assert np.ptp(result, axis=0)[[0, 2]].min() > 0.95
    assert np.abs(result[:, 1]).max() < 2 / 32


def test_a_net_that_says_the_same_everywhere_fails_with_a_reason(predicted_points):
    with pytest.raises(ReconstructionFailed, match="predictions of the network are empty"):
        predicted_points(np.full((32, 32, 32), 0.39))


def images_shown(inputs, settings) -> list[int]:
    """Which views the net is shown, in one pass."""
    net, recorded = new_net(settings.image_px, settings.channel_divisor, 0), []

    def record(contrasts):
        recorded.append((255 * (1 - contrasts)).mean(dim=(2, 3, 4)))
        return torch.zeros(1, 2, 32, 32, 32)

    net.forward = record
    assert (predict.occupancy_probabilities(inputs, settings, net) == 0.5).all()
    assert len(recorded) == 1
    return [round(float(level)) // 5 for level in recorded[0][0]]


@pytest.mark.parametrize(
    ("views", "chosen"), [(3, [0, 6, 3]), (7, [0, 6, 3, 1, 2, 4, 5]), (9, [0, 6, 3, 1, 2, 4, 5])]
)
def test_the_views_farthest_apart_are_seen_in_their_order_in_one_pass(
    inputs, settings, views, chosen
):
    assert images_shown(inputs, replace(settings, max_views=views)) == chosen


def test_they_look_from_all_sides():
    """Every eighth of a spiral of 40 looks from one side: its azimuths are 20 degrees apart."""
    settings, camera_centers = load_params().method.r2n2, fibonacci_sphere(40)
    chosen = images_shown(
        inputs_from(camera_centers), replace(settings, image_px=32, channel_divisor=32)
    )
    assert len(chosen) == 5
    assert np.linalg.norm(camera_centers[chosen].mean(axis=0)) < 0.3
    assert np.linalg.norm(camera_centers[::8].mean(axis=0)) > 0.5


def probabilities_of(settings, images, background):
    inputs = inputs_from(np.zeros((len(images), 3)))
    loaded = inputs.loaded | {Input.RGB: images, Input.BACKGROUND: background}
    net = new_net(settings.image_px, settings.channel_divisor, 0)
    return predict.occupancy_probabilities(replace(inputs, loaded=loaded), settings, net)


def test_an_empty_picture_says_the_same_whatever_its_background(settings):
    colors = np.array([[255, 255, 255], [0, 0, 0], [10, 200, 90]], np.uint8)
    answers = [
        probabilities_of(settings, np.tile(color, (3, 16, 16, 1)), np.tile(color / 255, (3, 1)))
        for color in colors
    ]
    np.testing.assert_allclose(answers[1:], [answers[0]] * 2, rtol=0, atol=1e-6)


def test_another_picture_gives_another_answer(settings):
    images = np.full((2, 3, 16, 16, 3), 255, np.uint8)
    images[0, :, 4:9, 2:14] = 90
    images[1, :, 2:14, 4:9] = 90
    one, other = (probabilities_of(settings, some, np.ones((3, 3))) for some in images)
    assert np.abs(one - other).max() > 1e-3
