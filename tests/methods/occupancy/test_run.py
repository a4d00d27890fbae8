"""The whole method: what is kept of a training, and what it answers."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from industnerf.artifacts.part import load_mesh
from industnerf.artifacts.state import State
from industnerf.artifacts.views import load_views
from industnerf.errors import ReconstructionFailed
from industnerf.geometry.sampling import sample_surface
from industnerf.methods import load_method
from industnerf.methods.base import Example, hand_over
from industnerf.methods.occupancy.lesson import Lesson
from industnerf.methods.occupancy.network import OccupancyNet
from industnerf.methods.occupancy.run import surface
from tests.methods.conftest import SIZE
from tests.methods.test_conformance import merged

OCCUPANCY = load_method("occupancy")
SMALL = merged("params.yaml", "conf/experiment/smoke.yaml").method.occupancy
SHORT = replace(SMALL, training=replace(SMALL.training, steps=6, validate_every=2))


def learn(folder: Path, scratch: Path, settings=SHORT, seed: int = 1) -> State:
    example = Example("part", folder / "part", folder / "views", OCCUPANCY.inputs)
    return OCCUPANCY.fit([example], settings, seed, scratch)


def given(folder: Path):
    return hand_over(OCCUPANCY, folder / "part", folder / "views")


@pytest.fixture(scope="module")
def learned(photographed, tmp_path_factory) -> State:
    return learn(photographed, tmp_path_factory.mktemp("scratch"), SMALL)


def test_same_seed_same_weights_other_seed_others(photographed, tmp_path):
    first, again, other = (
        learn(photographed, tmp_path / str(i), seed=seed) for i, seed in enumerate((1, 1, 2))
    )
    weights = "decoder.blocks.0.layer1.weight"
    assert all(
        first.arrays[name].tobytes() == again.arrays[name].tobytes() for name in first.arrays
    )
    assert (first.arrays[weights] != other.arrays[weights]).any()


def test_it_tells_how_the_training_went(photographed, tmp_path):
    state = learn(photographed, tmp_path)
    assert (state.parts, state.size, state.steps) == (1, "tiny", 6)
    assert len(state.history.loss) == 6
    assert len(state.validation.loss) == 3
    running = ("running_mean", "running_var", "num_batches_tracked")
    trained = [array for name, array in state.arrays.items() if not name.endswith(running)]
    assert state.parameters == sum(array.size for array in trained)


def test_what_is_learned_survives_the_disk(photographed, learned, tmp_path):
    learned.save(tmp_path)
    here, there = (
        OCCUPANCY.reconstruct(given(photographed), SMALL, state, 1).points_mm
        for state in (learned, State.load(tmp_path))
    )
    assert here.tobytes() == there.tobytes()


@pytest.mark.parametrize(("asked", "answers"), [(1, 1), (5, 5), (99, 12)])
def test_every_view_that_is_asked_answers(photographed, learned, asked, answers):
    settings = replace(SMALL, answers=asked)
    found = OCCUPANCY.reconstruct(given(photographed), settings, learned, 1)
    clouds = [found.points_mm, *found.others_mm]
    assert [len(points) for points in clouds] == [SMALL.points] * answers
    assert len({points.tobytes() for points in clouds}) == answers


def test_a_threshold_that_nothing_reaches_is_a_failure(photographed, learned):
    settings = replace(SMALL, threshold=1 - 1e-12)
    with pytest.raises(ReconstructionFailed, match=r"all 2 answers .* are empty"):
        OCCUPANCY.reconstruct(given(photographed), settings, learned, 1)


def test_a_higher_threshold_gives_a_smaller_solid(photographed, learned):
    reaches = []
    for threshold in (0.1, 0.5, 0.9):
        settings = replace(SMALL, threshold=threshold, answers=1)
        points = OCCUPANCY.reconstruct(given(photographed), settings, learned, 1).points_mm
        reaches.append(np.linalg.norm(points - points.mean(axis=0), axis=1).mean())
    assert reaches == sorted(reaches, reverse=True)


@pytest.mark.slow
def test_a_single_part_is_learned_by_heart(photographed, tmp_path, params):
    cpu = params.method.occupancy
    settings = replace(cpu, training=replace(cpu.training, steps=100))
    state = learn(photographed, tmp_path, settings)
    found = OCCUPANCY.reconstruct(given(photographed), settings, state, 1)
    mesh = load_mesh(photographed / "part")
    truth, _ = sample_surface(mesh.vertices, mesh.faces, 20000, np.random.default_rng(0))
    for points in (found.points_mm, *found.others_mm):
        away = [cKDTree(truth).query(points)[0], cKDTree(points).query(truth)[0]]
        # Both ways, in the mean, within two cells of the lattice that the surface is found on; a
        # ball of the mean extent is more than four of them off.
        assert max(x.mean() for x in away) < 2 * SIZE.max() * (1 + cpu.padding) / 64


def test_what_the_net_says_in_other_axes_comes_back_to_the_parts():
    """A ball of 0.2 about (0.25, 0, 0) in the view's axes."""
    turn = Rotation.from_euler("xyz", [0.4, -0.7, 1.1]).as_matrix()

    def ball(points, code):
        return 10 * (0.2 - (points - torch.tensor([0.25, 0, 0])).norm(dim=-1))

    settings = replace(SMALL, threshold=0.5, cells=16, subdivisions=1)
    net = OccupancyNet(settings)
    net.decoder.forward = ball
    rng = np.random.default_rng(0)
    points = surface(net, torch.zeros(4), turn, settings, rng) @ turn
    # Linear between the points of a lattice of h = 1.1 / 32: off by h^2 / 8 r; and faces with edges
    # of up to sqrt(3) h sag by 3 h^2 / 8 r.
    off = np.linalg.norm(points - [0.25, 0, 0], axis=1) - 0.2
    assert np.abs(off).max() < 4 * (1.1 / 32) ** 2 / (8 * 0.2)


def test_a_net_of_the_views_axes_is_taught_in_them(photographed: Path):
    inputs = load_method("occupancy").inputs
    example = Example("part", photographed / "part", photographed / "views", inputs)
    taught = Lesson.of([example], replace(SMALL, frame="view"), np.random.default_rng(0))
    expected = load_views(photographed / "views").cameras.c2w[:, :3, :3]
    turns, images = taught.glances.turns[0], taught.glances.images[0]
    assert len(turns) == len(images)
    assert all((np.abs(expected - turn).max(axis=(1, 2)) < 1e-12).any() for turn in turns)
