"""Training: what the net is shown, what it is told, and that it learns."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from industnerf.methods import load_method
from industnerf.methods.base import Example, load_inputs
from industnerf.methods.r2n2.network import new_net
from industnerf.methods.r2n2.predict import load_net, occupancy_probabilities
from industnerf.methods.r2n2.train import R2N2Dataset, fit_net
from tests.methods.r2n2.conftest import NO_AUGMENTATION


@pytest.fixture
def dataset(boxes, settings):
    """Three parts, and a net that says what it is asked to say."""
    net = new_net(settings.image_px, settings.channel_divisor, 0)
    return R2N2Dataset.of(boxes, replace(settings, augment=NO_AUGMENTATION), net, 0)


def test_a_net_that_says_nothing_loses_log_2(dataset):
    dataset.net.forward = lambda images: torch.zeros(len(images), 2, 32, 32, 32)
    loss = dataset.loss(np.array([0, 2]), np.random.default_rng(0))
    assert loss.item() == pytest.approx(math.log(2), rel=1e-6)


def test_the_loss_is_the_mean_over_all_voxels_of_the_right_part(dataset):
    def full(images):
        """Says of every voxel that it is full with odds of e^3."""
        scores = torch.zeros(len(images), 2, 32, 32, 32)
        scores[:, 1] = 3.0
        return scores

    dataset.net.forward = full
    for part_indices, size in enumerate((0.25, 0.5, 0.75)):
        loss = dataset.loss(np.array([part_indices, part_indices]), np.random.default_rng(0))
        share = dataset.occupied[part_indices].mean()
        # Edges of the bar are on borders of voxels: the surface fills at most one more all round.
        assert size**2 <= share <= (size + 2 / 32) ** 2
        right, wrong = math.log1p(math.exp(-3)), math.log1p(math.exp(3))
        assert loss.item() == pytest.approx(share * right + (1 - share) * wrong, rel=1e-5)


def sampled_images(dataset, batches=60):
    """All that the net is shown, batch by batch, as brightness (parts, views) from 0 to 255."""
    batches_seen, rng = [], np.random.default_rng(1)

    def record(images):
        assert images.shape[2:] == (3, 16, 16)
        batches_seen.append((255 * images).mean(dim=(2, 3, 4)).round().int().numpy())
        return torch.zeros(len(images), 2, 32, 32, 32)

    dataset.net.forward = record
    for _ in range(batches):
        dataset.loss(np.array([2, 0]), rng)
    return batches_seen


def test_a_batch_has_one_to_so_many_views_drawn_from_each_part(dataset):
    batches = sampled_images(dataset)
    assert {batch.shape for batch in batches} == {(2, 1), (2, 2), (2, 3)}
    first, second = (np.concatenate([batch[i] for batch in batches]) for i in (0, 1))
    assert set(first) == {150, 151, 152, 153}  # of the bar of 0.75, all its four views
    assert set(second) == {50, 51, 52, 53}
    assert any(len(set(views)) < len(views) for batch in batches for views in batch)  # put back


def test_pictures_differ_while_it_learns_and_stay_when_it_is_asked(boxes, settings):
    net = new_net(settings.image_px, settings.channel_divisor, 0)
    dataset = R2N2Dataset.of(boxes, settings, net, 0)
    known = {150, 151, 152, 153, 50, 51, 52, 53}
    assert set(np.concatenate([batch.ravel() for batch in sampled_images(dataset)])) > known
    net.eval()
    assert set(np.concatenate([batch.ravel() for batch in sampled_images(dataset)])) == known


def test_the_same_seed_gives_the_same_weights(boxes, settings, tmp_path):
    one, same, other = (
        fit_net(boxes, settings, seed, tmp_path / name)
        for seed, name in ((1, "one"), (1, "same"), (2, "other"))
    )
    assert all((one.arrays[name] == same.arrays[name]).all() for name in one.arrays)
    assert not all((one.arrays[name] == other.arrays[name]).all() for name in one.arrays)


def test_what_was_learned_says_how(boxes, settings, tmp_path):
    state = fit_net(boxes, settings, 1, tmp_path)
    assert (state.num_parts, state.size, state.steps) == (2, "tiny", 6)  # one is set apart
    assert state.num_parameters == sum(array.size for array in state.arrays.values())
    assert state.val_history.steps.tolist() == [1, 3, 5]
    net = load_net(settings, state)
    assert not net.training
    weights = net.state_dict()
    assert all((weights[name].numpy() == state.arrays[name]).all() for name in weights)


@pytest.mark.slow
def test_the_cpu_preset_learns_one_part_by_heart(rendered_part: Path, params, tmp_path):
    method, full_settings = load_method("r2n2"), params.method.r2n2
    # A part that is alone asks for no caution: thrice the rate, and a tenth of the steps.
    short_training = replace(full_settings.training, max_steps=180, batch_size=2, lr=1e-3)
    settings = replace(full_settings, training=short_training, augment=NO_AUGMENTATION)
    part, views = rendered_part / "part", rendered_part / "views"
    example = Example("part", "part", part, views, method.inputs)
    state = fit_net([example], settings, 0, tmp_path)
    assert state.size == "cpu"
    inputs = load_inputs(method, rendered_part / "part", rendered_part / "views")
    probabilities = (
        occupancy_probabilities(inputs, settings, load_net(settings, state)) > settings.threshold
    )
    target = R2N2Dataset.of([example], settings, new_net(63, 32, 0), 1).occupied[0]
    assert (probabilities & target).sum() / (probabilities | target).sum() > 0.95
