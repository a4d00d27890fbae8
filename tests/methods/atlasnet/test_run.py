"""The training, and its answers."""

from dataclasses import replace

import numpy as np
import pytest
import torch
from scipy.spatial.transform import Rotation

from industnerf.errors import ReconstructionFailed
from industnerf.methods import load_method
from industnerf.methods.atlasnet import run
from industnerf.methods.atlasnet.dataset import AtlasNetDataset
from industnerf.methods.atlasnet.network import build_network
from industnerf.methods.atlasnet.run import sample_patches, square_mesh
from industnerf.methods.base import Example, load_inputs
from tests.methods.test_conformance import merged

METHOD = load_method("atlasnet")


@pytest.fixture(scope="module")
def settings():
    """So few steps that nothing is learned."""
    smoke = merged("params.yaml", "conf/experiment/smoke.yaml").method.atlasnet
    training = replace(smoke.training, max_steps=14, batch_size=2, val_interval=2)
    return replace(smoke, patch_points=8, training=training)


@pytest.fixture
def examples(rendered_part):
    part, views = rendered_part / "part", rendered_part / "views"
    return [Example(name, name, part, views, METHOD.inputs) for name in ("a", "b", "c")]


def test_an_interrupted_training_ends_in_the_same_bytes(examples, settings, tmp_path, monkeypatch):
    uninterrupted = METHOD.fit(examples, settings, 0, tmp_path / "whole")
    loss, calls = AtlasNetDataset.loss, []

    def interrupt(*arguments):
        calls.append(arguments)
        if len(calls) == 9:
            raise KeyboardInterrupt
        return loss(*arguments)

    monkeypatch.setattr(AtlasNetDataset, "loss", interrupt)
    monkeypatch.setattr("industnerf.learning.training.CHECKPOINT_S", 0.0)
    with pytest.raises(KeyboardInterrupt):
        METHOD.fit(examples, settings, 0, tmp_path / "cut")
    torch.rand(1)  # what others draw meanwhile is no matter
    resumed = METHOD.fit(examples, settings, 0, tmp_path / "cut")
    assert list(resumed.arrays) == list(uninterrupted.arrays)
    for name, array in uninterrupted.arrays.items():
        assert resumed.arrays[name].tobytes() == array.tobytes(), name
    np.testing.assert_array_equal(resumed.train_history.loss, uninterrupted.train_history.loss)


def test_the_state_tells_how_the_training_went(examples, settings, tmp_path):
    state = METHOD.fit(examples, settings, 0, tmp_path)
    assert (state.num_parts, state.size, state.steps) == (2, "tiny", 14)  # one is set apart
    assert state.train_history.steps.tolist() == list(range(14))
    assert state.val_history.steps.tolist() == [1, 3, 5, 7, 9, 11, 13]
    trained = [array for name, array in state.arrays.items() if "running" not in name]
    batches = sum("num_batches" in name for name in state.arrays)
    assert state.num_parameters == sum(array.size for array in trained) - batches


@pytest.mark.parametrize("axes", ["part", "picture"])
def test_it_learns_points_in_the_axes_that_it_answers_in(axes, examples, settings):
    dataset = AtlasNetDataset(examples, replace(settings, output_axes=axes), rng_of(0))
    frames = np.stack([2.0 * np.eye(3)[[1, 2, 0]], np.eye(3)])
    targets = dataset._targets(np.array([0, 0]), frames, rng_of(1))
    assert targets.shape == (2, settings.target_points, 3)
    extents = np.ptp(targets, axis=1)
    whole = np.ptp(dataset.surfaces[0], axis=0)
    expected = [2 * whole[[2, 0, 1]], whole] if axes == "picture" else [whole, whole]
    np.testing.assert_allclose(extents, expected, atol=0.02)  # of 2400 random points


def rng_of(seed):
    return np.random.default_rng(seed)


def test_there_is_an_answer_to_each_view_asked(rendered_part, examples, settings, tmp_path):
    state = METHOD.fit(examples, settings, 0, tmp_path)
    inputs = load_inputs(METHOD, rendered_part / "part", rendered_part / "views")
    result = METHOD.reconstruct(inputs, replace(settings, eval_views=5), state, 0)
    clouds = [result.points_mm, *result.extra_clouds_mm]
    assert [len(points) for points in clouds] == 5 * [settings.points]
    assert len({points.tobytes() for points in clouds}) == 5


def test_a_training_that_diverges_says_so(examples, settings, tmp_path):
    settings_diverging = replace(settings, training=replace(settings.training, lr=1e30))
    with pytest.raises(ReconstructionFailed, match=r"not finite.*training\.lr is 1e\+30, lower"):
        METHOD.fit(examples, settings_diverging, 0, tmp_path)


@pytest.mark.parametrize("axes", ["part", "picture"])
def test_what_is_said_in_any_axes_comes_back_to_the_parts(axes, settings):
    """Every patch is the same square in the plane z = 1 of the axes that it answers in."""
    frame = 0.6 * Rotation.from_euler("xyz", [0.4, -0.7, 1.1]).as_matrix()
    seen = []

    def square(contrasts, frames, uv):
        seen.append(frames)
        flat = uv.permute(2, 0, 3, 1)
        return torch.cat([flat, torch.ones_like(flat[..., :1])], dim=-1).flatten(1, 2)

    answering = replace(settings, output_axes=axes)
    contrast = torch.zeros(3, settings.image_px, settings.image_px)
    net = build_network(settings)
    net.forward = square
    points = run.predict(net, contrast, frame, answering, rng_of(0))
    assert len(points) == settings.points
    torch.testing.assert_close(seen[0], torch.tensor(frame[None], dtype=torch.float32))
    in_axes = points @ frame if axes == "picture" else points
    np.testing.assert_allclose(in_axes[:, 2], 1, rtol=0, atol=1e-6)
    np.testing.assert_allclose(in_axes[:, :2].min(axis=0), 0, atol=0.02)
    np.testing.assert_allclose(in_axes[:, :2].max(axis=0), 1, atol=0.02)


@pytest.mark.parametrize("side", [2, 5])
def test_a_grid_covers_the_unit_square_once(side):
    uv, faces = square_mesh(side)
    assert sorted(map(tuple, uv)) == [
        (i / (side - 1), j / (side - 1)) for i in range(side) for j in range(side)
    ]
    along = uv[faces][:, 1:] - uv[faces][:, :1]
    areas = np.linalg.det(along) / 2
    # all triangles have one area, and one way round: together 1
    np.testing.assert_allclose(areas, 1 / (2 * (side - 1) ** 2), rtol=1e-12)
    assert len(faces) == 2 * (side - 1) ** 2


def plates(*sizes_and_heights, side=5):
    """Squares of edges (x, y) from the origin, level, at heights z."""
    uv, faces = square_mesh(side)
    flat = [np.c_[uv * size, np.full(len(uv), z)] for size, z in sizes_and_heights]
    return np.stack(flat), faces


def test_patches_have_points_by_their_area():
    points = sample_patches(*plates(((1, 1), 0.0), ((3, 1), 1.0)), 20000, np.random.default_rng(0))
    # 4 standard deviations of 20 000 draws are 1.2 %
    assert (points[:, 2] == 1).mean() == pytest.approx(0.75, abs=0.013)


def test_points_are_even_over_a_patch():
    points = sample_patches(*plates(((3, 1), 0.0)), 40000, np.random.default_rng(0))
    counts, _, _ = np.histogram2d(*points[:, :2].T, bins=(6, 2), range=[(0, 3), (0, 1)])
    # 12 bins of 3333 draws, each +- 55: within 5 of these
    assert np.abs(counts - 40000 / 12).max() < 275
    assert not points[:, 2].any()
