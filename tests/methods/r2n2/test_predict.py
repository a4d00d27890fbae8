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
    return MethodInputs("r2n2", cameras, cameras[:0], {Input.RGB: rgb, Input.PART_FRAME: FRAME})


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


def test_a_plane_is_where_the_probability_says(predicted_points):
    # 0.4 at x = 0.1, which is between two centers; linear, so that interpolation is exact
    probabilities = np.broadcast_to((0.4 + 0.5 * (0.1 - CENTERS))[:, None, None], (32, 32, 32))
    result = predicted_points(probabilities)
    assert result.shape == (500, 3)
    # the rest of the surface is the wall of the cube, half a voxel outside of the last centers
    on_plane = (np.abs(result[:, 1:]) < CENTERS[-1]).all(axis=1) & (result[:, 0] > -0.4)
    assert on_plane.sum() > 50
    # the only error is that of float32 in the marching cubes, on numbers up to 32
    np.testing.assert_allclose(result[on_plane, 0], 0.1, atol=32 * 2**-23)


def test_a_full_cube_is_the_whole_cube(predicted_points):
    result = predicted_points(np.ones((32, 32, 32)))
    # 1 inside, as far below the level outside: the surface is half a voxel from the last center
    np.testing.assert_allclose(np.abs(result).max(axis=1), 0.5, atol=0.5 / 32)
    np.testing.assert_allclose(np.ptp(result, axis=0), 1.0, atol=0.02)  # 80 points a wall


def test_points_are_uniform_by_area(predicted_points):
    r = np.linalg.norm(np.stack(np.meshgrid(CENTERS, CENTERS, CENTERS)), axis=0)
    result = predicted_points(0.4 + (0.3 - r))
    # A sphere of 0.3 on a lattice of h = 1/32: linear interpolation of the radius between centers
    # is off by h^2 / 8 r, and faces with edges of up to sqrt(3) h sag by 3 h^2 / 8 r.
    np.testing.assert_allclose(np.linalg.norm(result, axis=1), 0.3, atol=4 / 32**2 / 8 / 0.3)
    # Each coordinate of a uniform sphere is uniform: variance r^2 / 3, to 4 / sqrt(500) of it
    np.testing.assert_allclose(result.var(axis=0), 0.03, rtol=0.18)


def test_a_net_that_sees_nothing_fails_with_a_reason(predicted_points):
    with pytest.raises(ReconstructionFailed, match="predictions of the network are empty"):
        predicted_points(np.full((32, 32, 32), 0.39))


def images_shown(inputs, settings) -> list[int]:
    """Which views the net is shown, in one pass."""
    net, recorded = new_net(settings.image_px, settings.channel_divisor, 0), []

    def record(images):
        recorded.append((255 * images).mean(dim=(2, 3, 4)))
        return torch.zeros(1, 2, 32, 32, 32)

    net.forward = record
    assert (predict.occupancy_probabilities(inputs, settings, net) == 0.5).all()
    assert len(recorded) == 1
    return [round(float(level)) // 5 for level in recorded[0][0]]


@pytest.mark.parametrize(("views", "chosen"), [(3, [0, 3, 6]), (7, range(7)), (9, range(7))])
def test_the_views_farthest_apart_are_seen_in_one_pass(inputs, settings, views, chosen):
    assert images_shown(inputs, replace(settings, max_views=views)) == list(chosen)


def test_they_look_from_all_sides():
    """Every eighth of a spiral of 40 looks from one side: its azimuths are 20 degrees apart."""
    settings, camera_centers = load_params().method.r2n2, fibonacci_sphere(40)
    chosen = images_shown(
        inputs_from(camera_centers), replace(settings, image_px=32, channel_divisor=32)
    )
    assert len(chosen) == 5
    assert np.linalg.norm(camera_centers[chosen].mean(axis=0)) < 0.3
    assert np.linalg.norm(camera_centers[::8].mean(axis=0)) > 0.5
