"""Training: what the net is shown, what it is told, and that it learns."""

import math
from dataclasses import replace

import numpy as np
import pytest
import torch

from industnerf.learning.procedural_shapes import load_procedural_shapes
from industnerf.learning.training import TrainingSplit, train
from industnerf.learning.training_shape import NO_PRIOR
from industnerf.methods import load_method
from industnerf.methods.base import Example, load_inputs
from industnerf.methods.r2n2.network import new_net
from industnerf.methods.r2n2.predict import load_net, occupancy_probabilities
from industnerf.methods.r2n2.train import R2N2Dataset, fit_net
from industnerf.procedural_dataset import make_chunk
from tests.methods.r2n2.conftest import NO_AUGMENTATION


@pytest.fixture
def dataset(boxes, settings):
    """Three parts, and a net that says what it is asked to say."""
    net = new_net(settings.image_px, settings.channel_divisor, 0)
    return R2N2Dataset.of(boxes, replace(settings, augment=NO_AUGMENTATION), net)


def test_a_net_that_says_nothing_loses_log_2(dataset):
    dataset.net.forward = lambda images: torch.zeros(len(images), 2, 32, 32, 32)
    loss = dataset.loss(np.array([0, 2]), np.random.default_rng(0))
    assert loss.item() == pytest.approx(math.log(2), rel=1e-6)


def test_the_loss_is_the_mean_over_all_voxels_of_the_right_part(dataset):
    def full(contrasts):
        """Says of every voxel that it is full with odds of e^3."""
        scores = torch.zeros(len(contrasts), 2, 32, 32, 32)
        scores[:, 1] = 3.0
        return scores

    dataset.net.forward = full
    for part, size in enumerate((0.25, 0.5, 0.75)):
        loss = dataset.loss(np.array([part, part]), np.random.default_rng(0))
        share = size**2  # the bar's edges are on borders of voxels
        right, wrong = math.log1p(math.exp(-3)), math.log1p(math.exp(3))
        assert loss.item() == pytest.approx(share * right + (1 - share) * wrong, rel=1e-5)


def test_no_answer_is_better_than_how_full_voxels_are(dataset):
    """And what it loses then is their entropy: a voxel that is cut is no error."""
    filled = np.random.default_rng(0).integers(0, 256, (32, 32, 32), np.uint8)
    dataset.filled[1] = filled
    share = np.clip(filled / 255, 1e-6, 1 - 1e-6)
    entropy = -(share * np.log(share) + (1 - share) * np.log(1 - share)).mean()
    losses = []
    for shift in (0.0, 0.1, -0.1):

        def predict(contrasts, shift=shift):
            logits = torch.from_numpy(np.log(share / (1 - share)) + shift).float()
            return torch.stack([-logits / 2, logits / 2]).expand(len(contrasts), -1, -1, -1, -1)

        dataset.net.forward = predict
        losses.append(dataset.loss(np.array([1, 1]), np.random.default_rng(0)).item())
    assert losses[0] == pytest.approx(entropy, rel=1e-4)
    assert min(losses[1:]) > losses[0]


def sampled_images(dataset, batches=60):
    """All that the net is shown, batch by batch, as brightness (parts, views) from 0 to 255."""
    batches_seen, rng = [], np.random.default_rng(1)

    def record(contrasts):
        assert contrasts.shape[2:] == (3, 16, 16)
        levels = 255 * (1 - contrasts)  # before white
        batches_seen.append(levels.mean(dim=(2, 3, 4)).round().int().numpy())
        return torch.zeros(len(contrasts), 2, 32, 32, 32)

    dataset.net.forward = record
    for _ in range(batches):
        dataset.loss(np.array([2, 0]), rng)
    return batches_seen


def test_a_batch_has_the_first_views_of_each_part_mostly_all_of_them(dataset):
    batches = sampled_images(dataset, 200)
    for batch in batches:
        views = np.arange(batch.shape[1])
        np.testing.assert_array_equal(
            batch, [150 + views, 50 + views]
        )  # of the bar of 0.75, of 0.25
    counts = np.bincount([batch.shape[1] for batch in batches], minlength=5)
    assert (counts[1:3] > 0).all()
    # all of three in 0.7 + 0.3 / 3 of 200: 160 +- 5.7
    assert abs(counts[3] - 160) < 4 * 5.7


def test_pictures_differ_while_it_learns_and_stay_when_it_is_asked(boxes, settings):
    net = new_net(settings.image_px, settings.channel_divisor, 0)
    dataset = R2N2Dataset.of(boxes, settings, net)
    known = {150, 151, 152, 50, 51, 52}
    assert set(np.concatenate([batch.ravel() for batch in sampled_images(dataset)])) > known
    net.eval()
    batches = sampled_images(dataset)
    assert {batch.shape for batch in batches} == {(2, 3)}  # and all views
    assert set(np.concatenate([batch.ravel() for batch in batches])) == known


def test_a_new_part_is_seen_as_one_that_is_learned_from(rendered_part, settings):
    """The same views, in the same order."""
    shown, method = [], load_method("r2n2")
    net = new_net(settings.image_px, settings.channel_divisor, 0).eval()

    def record(contrasts):
        shown.append(contrasts[0])
        return torch.zeros(len(contrasts), 2, 32, 32, 32)

    net.forward = record
    part, views = rendered_part / "part", rendered_part / "views"
    example = Example("part", "part", part, views, method.inputs)
    R2N2Dataset.of([example], settings, net).loss(np.array([0, 0]), np.random.default_rng(0))
    occupancy_probabilities(load_inputs(method, part, views), settings, net)
    learned, asked = shown
    assert learned.shape == (3, 3, 16, 16)
    assert learned.abs().amax(dim=(1, 2, 3)).min() > 0.2
    assert torch.equal(learned, asked)
    assert not torch.equal(learned[0], learned[1])


def test_the_same_seed_gives_the_same_weights(boxes, settings, tmp_path):
    one, same, other = (
        fit_net(boxes, settings, seed, tmp_path / name, NO_PRIOR)
        for seed, name in ((1, "one"), (1, "same"), (2, "other"))
    )
    assert all((one.arrays[name] == same.arrays[name]).all() for name in one.arrays)
    assert not all((one.arrays[name] == other.arrays[name]).all() for name in one.arrays)


def test_what_was_learned_says_how(boxes, settings, tmp_path):
    state = fit_net(boxes, settings, 1, tmp_path, NO_PRIOR)
    assert (state.num_parts, state.size, state.steps) == (2, "tiny", 6)  # one is set apart
    assert state.num_parameters == sum(array.size for array in state.arrays.values())
    assert state.val_history.steps.tolist() == [1, 3, 5]
    net = load_net(settings, state)
    assert not net.training
    weights = net.state_dict()
    assert all((weights[name].numpy() == state.arrays[name]).all() for name in weights)


@pytest.mark.slow
def test_the_rate_of_pretraining_leaves_the_gates_open(params, tmp_path):
    """At 1e-3 two thirds of this seed's gates saturate within 200 steps, some for good.

    Beyond 4 and -4 a gate passes less than 2 % of a gradient.  The training is broken off after 200
    steps, so that its rate falls no faster than in a whole pretraining.
    """
    (tmp_path / "0000").mkdir()
    make_chunk(
        tmp_path / "0000",
        indices=range(64),
        seed=0,
        settings=params.procedural,
        views=params.views,
    )
    settings = params.method.r2n2
    net = new_net(settings.image_px, settings.channel_divisor, 0)
    dataset = R2N2Dataset.of(load_procedural_shapes(tmp_path, ["0000"]), settings, net)
    arguments = {}
    for name in ("update", "reset", "candidate"):
        getattr(net.gru, name).register_forward_hook(
            lambda _, __, value, name=name: arguments.update({name: value})
        )
    left = iter(range(200))

    def loss(ids, rng):
        next(left)  # ends the training by StopIteration
        return dataset.loss(ids, rng)

    split = TrainingSplit(list(range(64)), [])
    with pytest.raises(StopIteration):
        train(net, loss, split, settings.pretraining, 0, tmp_path / "checkpoint.pt")
    saturated = [(value.abs() > 4).float().mean().item() for value in arguments.values()]
    assert np.mean(saturated) < 0.5, saturated
