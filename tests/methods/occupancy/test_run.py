"""The whole method: what is kept of a training, and what it answers."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from industnerf.artifacts.part import load_mesh
from industnerf.artifacts.state import ModelState
from industnerf.artifacts.views import load_views
from industnerf.errors import ReconstructionFailed
from industnerf.geometry.sampling import sample_surface
from industnerf.methods import load_method
from industnerf.methods.base import Example, load_inputs
from industnerf.methods.occupancy.dataset import OccupancyDataset
from industnerf.methods.occupancy.network import OccupancyNet
from industnerf.methods.occupancy.run import surface
from tests.methods.conftest import SIZE
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


def test_a_threshold_that_nothing_reaches_is_a_failure(rendered_part, fitted_state):
    settings = replace(SMALL, threshold=1 - 1e-12)
    with pytest.raises(ReconstructionFailed, match=r"all 2 predictions .* are empty"):
        OCCUPANCY.reconstruct(inputs_of(rendered_part), settings, fitted_state, 1)


def test_a_higher_threshold_gives_a_smaller_solid(rendered_part, fitted_state):
    reaches = []
    for threshold in (0.1, 0.5, 0.9):
        settings = replace(SMALL, threshold=threshold, eval_views=1)
        points = OCCUPANCY.reconstruct(
            inputs_of(rendered_part), settings, fitted_state, 1
        ).points_mm
        reaches.append(np.linalg.norm(points - points.mean(axis=0), axis=1).mean())
    assert reaches == sorted(reaches, reverse=True)


@pytest.mark.slow
def test_a_single_part_is_learned_by_heart(rendered_part, tmp_path, params):
    cpu = params.method.occupancy
    settings = replace(cpu, training=replace(cpu.training, max_steps=100))
    state = fit_state(rendered_part, tmp_path, settings)
    result = OCCUPANCY.reconstruct(inputs_of(rendered_part), settings, state, 1)
    mesh = load_mesh(rendered_part / "part")
    truth, _ = sample_surface(mesh.vertices, mesh.faces, 20000, np.random.default_rng(0))
    for points in (result.points_mm, *result.extra_clouds_mm):
        distance = [cKDTree(truth).query(points)[0], cKDTree(points).query(truth)[0]]
        # Both ways, in the mean, within two cells of the lattice that the surface is found on; a
        # ball of the mean extent is more than four of them off.
        assert max(x.mean() for x in distance) < 2 * SIZE.max() * (1 + cpu.padding) / 64


def test_what_the_net_says_in_other_axes_comes_back_to_the_parts():
    """A ball of 0.2 about (0.25, 0, 0) in the view's axes."""
    rotation = Rotation.from_euler("xyz", [0.4, -0.7, 1.1]).as_matrix()

    def ball(points, code):
        return 10 * (0.2 - (points - torch.tensor([0.25, 0, 0])).norm(dim=-1))

    settings = replace(SMALL, threshold=0.5, resolution_0=16, upsampling_steps=1)
    net = OccupancyNet(settings)
    net.decoder.forward = ball
    rng = np.random.default_rng(0)
    points = surface(net, torch.zeros(4), rotation, settings, rng) @ rotation
    # Linear between the points of a lattice of h = 1.1 / 32: off by h^2 / 8 r; and faces with edges
    # of up to sqrt(3) h sag by 3 h^2 / 8 r.
    error = np.linalg.norm(points - [0.25, 0, 0], axis=1) - 0.2
    assert np.abs(error).max() < 4 * (1.1 / 32) ** 2 / (8 * 0.2)


def test_a_net_of_the_views_axes_is_taught_in_them(rendered_part: Path):
    inputs = load_method("occupancy").inputs
    example = Example("part", "part", rendered_part / "part", rendered_part / "views", inputs)
    dataset = OccupancyDataset.of(
        [example], replace(SMALL, output_axes="view"), np.random.default_rng(0)
    )
    expected = load_views(rendered_part / "views").cameras.c2w[:, :3, :3]
    rotations, images = dataset.view_sampler.rotations[0], dataset.view_sampler.images[0]
    assert len(rotations) == len(images)
    assert all(
        (np.abs(expected - rotation).max(axis=(1, 2)) < 1e-12).any() for rotation in rotations
    )
