"""The three trainings: what each may change, how they share the steps, and that they resume."""

from dataclasses import replace

import numpy as np
import pytest
import torch
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation
from torch.nn.modules.batchnorm import _BatchNorm

from industnerf.artifacts.part import load_mesh
from industnerf.config import load_params
from industnerf.errors import ReconstructionFailed
from industnerf.geometry.sampling import sample_surface
from industnerf.methods import load_method
from industnerf.methods.atlasnet import run
from industnerf.methods.atlasnet.run import sample_patches, square_mesh
from industnerf.methods.base import Example, load_inputs
from industnerf.schema import AugmentSettings
from tests.methods.test_conformance import merged

METHOD = load_method("atlasnet")


@pytest.fixture(scope="module")
def settings():
    """So few steps that nothing is learned, and both kinds of phases are there."""
    smoke = merged("params.yaml", "conf/experiment/smoke.yaml").method.atlasnet
    training = replace(smoke.training, max_steps=14, batch_size=2, val_interval=2)
    return replace(smoke, patch_points=8, training=training)


@pytest.fixture
def examples(rendered_part):
    part, views = rendered_part / "part", rendered_part / "views"
    return [Example(name, name, part, views, METHOD.inputs) for name in ("a", "b", "c")]


@pytest.fixture
def traced_training(monkeypatch):
    """Each phase's net before and after, by the name of its checkpoint; `stop` names a phase."""
    calls, stop = {}, set()
    train = run.train

    def copy(net):
        return {name: weights.detach().clone() for name, weights in net.named_parameters()}

    def traced_train(net, loss, parts, plan, seed, checkpoint):
        if checkpoint.stem in stop:
            raise KeyboardInterrupt
        before = copy(net)
        trained = train(net, loss, parts, plan, seed, checkpoint)
        calls[checkpoint.stem] = before, copy(net), plan
        return trained

    monkeypatch.setattr(run, "train", traced_train)
    return calls, stop


def test_each_phase_teaches_what_it_should(examples, settings, tmp_path, traced_training):
    calls, _ = traced_training
    METHOD.fit(examples, settings, 0, tmp_path)
    assert list(calls) == ["auto_encoder", "encoder", "together"]
    for name, (before, after, _) in calls.items():
        moved = {part.partition(".")[0] for part in before if (before[part] != after[part]).any()}
        assert moved == ({"encoder"} if name == "encoder" else {"encoder", "decoder"})
    for one, other in (("auto_encoder", "encoder"), ("encoder", "together")):
        last, first = calls[one][1], calls[other][0]
        assert all(torch.equal(last[part], first[part]) for part in last if "decoder" in part)
    assert all(torch.equal(calls["encoder"][1][k], v) for k, v in calls["together"][0].items())


def test_phases_share_the_steps_and_the_last_learns_slowly(settings):
    plans = run.phase_settings(
        replace(settings, training=replace(settings.training, max_steps=700))
    )
    assert [plan.max_steps for plan in plans] == [300, 300, 100]
    lr = settings.training.lr
    assert [plan.lr for plan in plans] == [lr, lr, pytest.approx(lr / 10)]
    milestones = settings.training.lr_milestones
    assert [plan.lr_milestones for plan in plans] == [milestones, milestones, milestones[:1]]


def test_an_interrupted_training_ends_in_the_same_bytes(
    examples, settings, tmp_path, traced_training
):
    _, stop = traced_training
    uninterrupted = METHOD.fit(examples, settings, 0, tmp_path / "whole")
    stop.add("encoder")
    with pytest.raises(KeyboardInterrupt):
        METHOD.fit(examples, settings, 0, tmp_path / "cut")
    stop.clear()
    torch.rand(1)  # what others draw meanwhile is no matter
    resumed = METHOD.fit(examples, settings, 0, tmp_path / "cut")
    assert list(resumed.arrays) == list(uninterrupted.arrays)
    for name, array in uninterrupted.arrays.items():
        assert resumed.arrays[name].tobytes() == array.tobytes(), name
    np.testing.assert_array_equal(resumed.train_history.loss, uninterrupted.train_history.loss)


def test_the_state_tells_how_all_phases_went(examples, settings, tmp_path):
    state = METHOD.fit(examples, settings, 0, tmp_path)
    assert (state.num_parts, state.size, state.steps) == (2, "tiny", 14)  # one is set apart
    assert state.train_history.levels == {"auto_encoder": 0, "encoder": 6, "together": 12}
    assert state.train_history.steps.tolist() == list(range(14))
    assert state.val_history.steps.tolist() == [1, 3, 5, 7, 9, 11, 13]
    trained = [array for name, array in state.arrays.items() if "running" not in name]
    batches = sum("num_batches" in name for name in state.arrays)
    assert state.num_parameters == sum(array.size for array in trained) - batches


@pytest.mark.parametrize("unsettled", ["auto_encoder", "encoder", "together"])
def test_it_is_settled_if_both_trainings_on_pictures_are(
    unsettled, examples, settings, tmp_path, monkeypatch
):
    train = run.train

    def fake_train(net, loss, parts, plan, seed, checkpoint):
        trained = train(net, loss, parts, plan, seed, checkpoint)
        return replace(trained, has_converged=checkpoint.stem != unsettled)

    monkeypatch.setattr(run, "train", fake_train)
    assert METHOD.fit(examples, settings, 0, tmp_path).converged == (unsettled == "auto_encoder")


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


def test_the_last_phase_learns_with_the_statistics_it_predicts_with(
    examples, settings, tmp_path, monkeypatch
):
    loss, is_training = run.AtlasNetDataset.image_loss, []

    def record(dataset, net, batch, rng):
        if net.training:
            norms = [module for module in net.modules() if isinstance(module, _BatchNorm)]
            is_training.append({norm.training for norm in norms})
        return loss(dataset, net, batch, rng)

    monkeypatch.setattr(run.AtlasNetDataset, "image_loss", record)
    METHOD.fit(examples, settings, 0, tmp_path)
    assert is_training == 6 * [{True}] + 2 * [{False}]


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_the_cpu_sizes_learn_one_part_by_heart(root, rendered_part, examples, tmp_path, seed):
    settings = load_params(root / "params.yaml").method.atlasnet
    training = replace(settings.training, max_steps=700, batch_size=4, lr=2e-3, val_interval=50)
    plain = AugmentSettings(roll_deg=0.0, zoom=0.0, color_jitter=0.0, noise=0.0)
    settings = replace(settings, train_views=4, eval_views=4, patch_points=24, training=training)
    state = METHOD.fit(examples[:1], replace(settings, augment=plain), seed, tmp_path)
    inputs = load_inputs(METHOD, rendered_part / "part", rendered_part / "views")
    points_found = METHOD.reconstruct(inputs, settings, state, seed)
    mesh = load_mesh(rendered_part / "part")
    truth, _ = sample_surface(mesh.vertices, mesh.faces, 20000, np.random.default_rng(0))
    size = np.linalg.norm(np.ptp(truth, axis=0))
    for points in (points_found.points_mm, *points_found.extra_clouds_mm):
        # Both ways, in the mean: a ball of the mean extent is 5.5 and 8 % of the diagonal off.
        distance = [cKDTree(truth).query(points)[0], cKDTree(points).query(truth)[0]]
        assert max(x.mean() for x in distance) < 0.03 * size


def test_what_is_said_in_the_axes_of_a_view_comes_back_to_the_parts(examples, settings, tmp_path):
    state = METHOD.fit(examples, settings, 0, tmp_path)
    images = np.random.default_rng(0).integers(0, 256, (2, *2 * [settings.image_px], 3), np.uint8)
    rotations = Rotation.from_euler("xyz", [[0.4, -0.7, 1.1], [0, 0, 0]]).as_matrix()
    straight = run.predict_clouds(images, np.tile(np.eye(3), (2, 1, 1)), settings, state, 0)
    turned = run.predict_clouds(images, rotations, settings, state, 0)
    # the same triangles are drawn from: rounding may tip a draw at the border of two, seldom
    near = np.isclose(turned[0] @ rotations[0], straight[0], rtol=0, atol=1e-6)
    assert near.all(axis=1).mean() > 0.99
    np.testing.assert_array_equal(turned[1], straight[1])


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
