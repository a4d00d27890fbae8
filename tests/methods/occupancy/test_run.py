"""The whole method: what is kept of a training, and what it answers."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from scipy.spatial.transform import Rotation

from industnerf.artifacts.state import ModelState
from industnerf.methods import load_method
from industnerf.methods.base import Example, load_inputs
from industnerf.methods.occupancy.network import OccupancyNet
from industnerf.methods.occupancy.run import surface
from tests.methods.test_conformance import merged

OCCUPANCY = load_method("occupancy")
SMALL = merged("params.yaml", "conf/experiment/smoke.yaml").method.occupancy
SHORT = replace(SMALL, training=replace(SMALL.training, max_steps=6, val_interval=2))


def fit_state(folder: Path, scratch: Path, settings=SHORT, seed: int = 1) -> ModelState:
    example = Example("part", "part", folder / "part", folder / "views", OCCUPANCY.inputs)
    return OCCUPANCY.fit([example], settings, seed, scratch)


def inputs_of(folder: Path):
    return load_inputs(OCCUPANCY, folder / "part", folder / "views")


@pytest.fixture(scope="module")
def fitted_state(rendered_part, tmp_path_factory) -> ModelState:
    return fit_state(rendered_part, tmp_path_factory.mktemp("scratch"), SMALL)


def test_same_seed_same_weights_other_seed_others(rendered_part, tmp_path):
    first, again, other = (
        fit_state(rendered_part, tmp_path / str(i), seed=seed) for i, seed in enumerate((1, 1, 2))
    )
    weights = "decoder.blocks.0.layer1.weight"
    assert all(
        first.arrays[name].tobytes() == again.arrays[name].tobytes() for name in first.arrays
    )
    assert (first.arrays[weights] != other.arrays[weights]).any()


def test_it_tells_how_the_training_went(rendered_part, tmp_path):
    state = fit_state(rendered_part, tmp_path)
    assert (state.num_parts, state.size, state.steps) == (1, "tiny", 6)
    assert len(state.train_history.loss) == 6
    assert len(state.val_history.loss) == 3
    unfinished = ("running_mean", "running_var", "num_batches_tracked")
    trained = [array for name, array in state.arrays.items() if not name.endswith(unfinished)]
    assert state.num_parameters == sum(array.size for array in trained)


def test_what_is_learned_survives_the_disk(rendered_part, fitted_state, tmp_path):
    fitted_state.save(tmp_path)
    here, there = (
        OCCUPANCY.reconstruct(inputs_of(rendered_part), SMALL, state, 1).points_mm
        for state in (fitted_state, ModelState.load(tmp_path))
    )
    assert here.tobytes() == there.tobytes()


@pytest.mark.parametrize(("asked", "answers"), [(1, 1), (5, 5), (99, 12)])
def test_every_view_that_is_asked_answers(rendered_part, fitted_state, asked, answers):
    settings = replace(SMALL, eval_views=asked)
    result = OCCUPANCY.reconstruct(inputs_of(rendered_part), settings, fitted_state, 1)
    clouds = [result.points_mm, *result.extra_clouds_mm]
    assert [len(points) for points in clouds] == [SMALL.points] * answers
    assert len({points.tobytes() for points in clouds}) == answers


@pytest.mark.parametrize("axes", ["part", "picture", "both"])
def test_what_the_net_says_in_any_axes_comes_back_to_the_parts(axes):
    """A ball about a place along one axis of the part, or of the picture; its sum is its volume."""
    frame = 0.6 * Rotation.from_euler("xyz", [0.4, -0.7, 1.1]).as_matrix()
    scale = 1.0 if axes == "part" else 0.6
    center = scale * np.array([0.2, 0, 0])

    def ball(points, code):
        # from probability 1 at 0.15 to 0 at 0.25
        distance = (points[..., :3] - torch.tensor(center).float()).norm(dim=-1) / scale
        return torch.logit((0.5 + (0.2 - distance) / 0.1).clamp(0, 1), eps=1e-6)

    settings = replace(SMALL, query_axes=axes, resolution_0=16, upsampling_steps=1)
    net = OccupancyNet(settings)
    net.decoder.forward = ball
    points = surface(net, torch.zeros(4), frame, settings, np.random.default_rng(0))
    truth = center if axes == "part" else center @ np.linalg.inv(frame)
    radius = (0.2**3 + 0.2 * 0.05**2) ** (1 / 3)
    # Linear between the points of a lattice of h = 1.1 / 32: off by h^2 / 8 r; and faces with edges
    # of up to sqrt(3) h sag by 3 h^2 / 8 r.  The level is chosen on a lattice twice as coarse, of
    # 17^3 points: 4 deviations of the 80 or so that are cut move the radius by 0.003.
    error = np.linalg.norm(points - truth, axis=1) - radius
    assert np.abs(error).max() < 4 * (1.1 / 32) ** 2 / (8 * radius) + 0.003


def test_a_part_that_the_net_is_unsure_of_is_as_large_as_it_expects(rendered_part, fitted_state):
    """Though nowhere is as likely to be inside as not: the last bias makes all of it unlikely."""
    unsure = dict(fitted_state.arrays)
    unsure["decoder.last.bias"] = unsure["decoder.last.bias"] - 6
    state = replace(fitted_state, arrays=unsure)
    result = OCCUPANCY.reconstruct(inputs_of(rendered_part), SMALL, state, 1)
    assert [len(x) for x in (result.points_mm, *result.extra_clouds_mm)] == 2 * [SMALL.points]
