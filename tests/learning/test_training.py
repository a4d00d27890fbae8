"""The loop that nets are trained with, on nets whose way is known in closed form.

Adam moves a number whose gradient is constant by the rate at every step -- m / sqrt(v) is the
gradient's sign -- but for its epsilon: 1e-8 of the rate, less than float32 tells.  What the rate
is at a step is tested by itself.
"""

from dataclasses import dataclass, replace
from hashlib import sha256
from pathlib import Path

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from torch import nn

from industnerf.artifacts.state import ModelState
from industnerf.errors import BadParams, ReconstructionFailed
from industnerf.learning import training
from industnerf.learning.fit import fit_network
from industnerf.learning.training import (
    TrainingSplit,
    has_converged,
    lr_factor,
    train,
    train_val_split,
)
from industnerf.learning.training_shape import NO_PRIOR, Prior
from industnerf.methods.base import Example
from industnerf.schema import TrainingSettings

SETTINGS = TrainingSettings(
    max_steps=10,
    batch_size=2,
    lr=0.25,
    weight_decay=0.0,
    val_fraction=0.5,
    val_interval=1,
    patience=99,
    keep="best",
)


class ScalarNet(nn.Module):
    """A net of one number, which starts at 0."""

    def __init__(self) -> None:
        super().__init__()
        self.number = nn.Parameter(torch.zeros(1))


def rising_loss(net, validation):
    """A loss that drives the net's number up steadily, and says `validation` when asked."""
    remaining = iter(np.repeat(validation, 2))  # one part asked four times is two batches of two
    return lambda part_indices, rng: (
        -net.number.sum() if net.training else torch.tensor(next(remaining))
    )


def way(steps, max_steps=10, lr=0.25):
    """How far so many steps drive it."""
    return lr * sum(lr_factor(step, max_steps) for step in range(steps))


def train_scalar(validation, scratch, start=0.0, starts_trained=False, **changes):
    """The net and how it went; one part is learned from, and one asked."""
    net, settings = ScalarNet(), replace(SETTINGS, **changes)
    nn.init.constant_(net.number, start)
    loss, split = rising_loss(net, validation), TrainingSplit([0], [1])
    path = scratch / "checkpoint"
    result = train(net, loss, split, settings, 0, path, starts_trained=starts_trained)
    return net.number.item(), result


def test_the_weights_of_the_best_validation_are_kept(tmp_path):
    number, result = train_scalar([3.0, 2.0, 1.0, 2.0, 3.0], tmp_path, val_interval=2)
    assert number == pytest.approx(way(6))
    assert result.steps == 10
    assert result.val_history.loss.tolist() == [3.0, 2.0, 1.0, 2.0, 3.0]
    assert result.val_history.steps.tolist() == [1, 3, 5, 7, 9]  # as the training's, from 0
    assert result.train_history.steps.tolist() == list(range(10))
    np.testing.assert_allclose(
        result.train_history.loss, [-way(step) for step in range(10)], rtol=1e-5
    )


def test_the_weights_of_the_last_step_are_kept_where_that_is_asked(tmp_path):
    """However good others were; the losses are told all the same."""
    number, result = train_scalar([3.0, 1.0, 2.0, 2.0, 3.0], tmp_path, val_interval=2, keep="last")
    assert number == pytest.approx(way(10))
    assert result.val_history.loss.tolist() == [3.0, 1.0, 2.0, 2.0, 3.0]


def test_weights_that_were_there_before_do_not_settle_a_training_that_keeps_its_last(tmp_path):
    falling = [1.0, *np.arange(10.0)[::-1] + 2]
    results = {
        keep: train_scalar(falling, tmp_path / keep, starts_trained=True, keep=keep)[1]
        for keep in ("best", "last")
    }
    assert results["best"].has_converged
    assert not results["last"].has_converged
    untrained = train_scalar(
        [1.0], tmp_path / "none", starts_trained=True, keep="last", max_steps=0
    )
    assert untrained[1].has_converged


def test_the_last_step_is_validated_whatever_its_number(tmp_path):
    number, result = train_scalar([2.0, 1.0], tmp_path, max_steps=5, val_interval=3)
    assert result.val_history.steps.tolist() == [2, 4]
    assert number == pytest.approx(way(5, 5))


def test_it_stops_when_no_validation_was_better_for_so_long(tmp_path):
    number, result = train_scalar([3.0, 2.0, 2.5, 2.0, 9.0, 0.0], tmp_path, patience=3)
    assert result.steps == 5  # the second is the best of five: to equal it is not to be better
    assert number == pytest.approx(way(2))


def test_who_stopped_early_is_settled_and_who_still_gained_is_not(tmp_path):
    down = np.arange(10.0)[::-1].tolist()
    assert train_scalar([*down[:3], *8 * [9.0]], tmp_path / "early", patience=3)[1].has_converged
    assert not train_scalar([*down[:6], 9.0], tmp_path / "steep", patience=1)[1].has_converged
    assert not train_scalar(down, tmp_path / "late", patience=1)[1].has_converged


def test_the_rate_rises_over_100_steps_and_falls_as_half_a_cosine_to_a_hundredth():
    rates = np.array([lr_factor(step, 2000) for step in range(2000)])
    cosine = 0.01 + 0.99 * (1 + np.cos(np.pi * np.arange(2000) / 2000)) / 2
    np.testing.assert_allclose(rates[100:], cosine[100:], rtol=1e-12)
    np.testing.assert_allclose(rates[:100], cosine[:100] * np.arange(1, 101) / 100, rtol=1e-12)
    assert rates[1000] == pytest.approx((1 + 0.01) / 2)
    assert rates[-1] == pytest.approx(0.01, rel=1e-3)
    assert lr_factor(0, 1) == pytest.approx(0.01)  # of a training of one step: warm-up


class Pair(nn.Module):
    """Two numbers."""

    def __init__(self) -> None:
        super().__init__()
        self.pair = nn.Parameter(torch.zeros(2))


def test_a_long_gradient_is_shortened_and_keeps_its_direction(tmp_path):
    """Against Adam by hand, on the gradients (0.3, 0.4) and 1000 times that, 500 long."""
    net, factors = Pair(), iter([1.0, 1000.0])

    def steep(part_indices, rng):
        return (net.pair * torch.tensor([0.3, 0.4])).sum() * (next(factors) if net.training else 1)

    split = TrainingSplit([0], [0])
    train(net, steep, split, replace(SETTINGS, max_steps=2), 0, tmp_path / "checkpoint")
    place, m, v = np.zeros(2), np.zeros(2), np.zeros(2)
    for step, gradient in enumerate((np.array([0.3, 0.4]), np.array([3.0, 4.0]))):
        m, v = 0.9 * m + 0.1 * gradient, 0.999 * v + 0.001 * gradient**2
        unbiased = m / (1 - 0.9 ** (step + 1)), v / (1 - 0.999 ** (step + 1))
        place -= 0.25 * lr_factor(step, 2) * unbiased[0] / np.sqrt(unbiased[1])
    np.testing.assert_allclose(net.pair.detach(), place, rtol=1e-4)


class Layer(nn.Module):
    """A matrix and a vector that learn, and a matrix that does not."""

    def __init__(self) -> None:
        super().__init__()
        self.matrix = nn.Parameter(torch.tensor([[2.0, -3.0]]))
        self.vector = nn.Parameter(torch.tensor([2.0, -3.0]))
        self.frozen = nn.Parameter(torch.tensor([[2.0, -3.0]]), requires_grad=False)


def test_matrices_decay_and_what_is_frozen_stays(tmp_path):
    net, settings = Layer(), replace(SETTINGS, weight_decay=0.1)

    def indifferent(part_indices, rng):
        return 0 * (net.matrix * net.frozen).sum() + 0 * net.vector.sum()

    split = TrainingSplit([0], [0])
    train(net, indifferent, split, replace(settings, max_steps=1), 0, tmp_path / "checkpoint")
    # decay is all of the gradient, and Adam makes one step of the rate of it
    step = way(1, 1)
    torch.testing.assert_close(net.matrix.data, torch.tensor([[2.0 - step, step - 3.0]]))
    assert net.vector.tolist() == [2.0, -3.0]
    assert net.frozen.tolist() == [[2.0, -3.0]]


def test_parts_set_apart_are_asked_alike_and_never_learned_from(tmp_path):
    net, train_calls, val_calls = ScalarNet(), [], []

    def record_loss(part_indices, rng):
        (train_calls if net.training else val_calls).append((part_indices.tolist(), rng.random()))
        return net.number.sum() if net.training else torch.tensor(1.0)

    settings = replace(SETTINGS, batch_size=3, val_interval=5)
    split = TrainingSplit([1, 4, 6], [0, 2, 3, 5])
    train(net, record_loss, split, settings, 0, tmp_path / "checkpoint")
    assert {part for part_indices, _ in train_calls for part in part_indices} == {1, 4, 6}
    first, second = val_calls[: len(val_calls) // 2], val_calls[len(val_calls) // 2 :]
    assert first == second  # with the same draws
    often = np.bincount([part for part_indices, _ in first for part in part_indices], minlength=6)
    assert set(often[[0, 2, 3, 5]]) <= {4, 5}  # 18 places for four parts, four times each
    assert not often[[1, 4]].any()


@pytest.mark.parametrize("batch_size", [2, 5, 8])
def test_half_of_a_batch_are_solids_where_there_are_any(tmp_path, batch_size):
    """The smaller half, and none of those that are asked."""
    net, batches, asked = ScalarNet(), [], set()

    def record_loss(part_indices, rng):
        if net.training:
            batches.append(part_indices)
        else:
            asked.update(part_indices.tolist())
        return net.number.sum()

    split = TrainingSplit([0, 2], [1], solids=[3, 4, 5])
    settings = replace(SETTINGS, batch_size=batch_size, max_steps=40, val_interval=20)
    train(net, record_loss, split, settings, 0, tmp_path / "checkpoint")
    solids = np.array(batches) >= 3
    assert (solids.sum(axis=1) == batch_size // 2).all()
    assert {part for batch in batches for part in batch.tolist()} == {0, 2, 3, 4, 5}
    assert asked == {1}


def test_weights_that_were_trained_are_validated_first_and_kept_where_nothing_is_better(tmp_path):
    number, result = train_scalar(
        [1.0, *10 * [2.0]], tmp_path / "worse", start=5.0, starts_trained=True
    )
    assert number == 5
    assert result.val_history.steps.tolist() == [0, *range(10)]  # before the first step
    assert result.val_history.loss[0] == 1
    number, _ = train_scalar(
        [1.0, 0.5, *9 * [2.0]], tmp_path / "better", start=5.0, starts_trained=True
    )
    assert number == pytest.approx(5 + way(1))


def test_weights_at_random_are_not_validated(tmp_path):
    number, result = train_scalar([1.0, *9 * [2.0]], tmp_path, start=5.0)
    assert number == pytest.approx(5 + way(1))
    assert result.val_history.steps.tolist() == list(range(10))


class NoisyNet(nn.Module):
    """With numbers that no optimizer knows: the running mean of a batch norm."""

    def __init__(self) -> None:
        super().__init__()
        self.layers = nn.Sequential(nn.Linear(3, 4), nn.BatchNorm1d(4), nn.Linear(4, 1))


@pytest.mark.parametrize(("starts_trained", "norm_steps"), [(False, 9), (True, 0)])
def test_batch_norm_ends_with_the_statistics_that_it_predicts_by(
    tmp_path, starts_trained, norm_steps
):
    """It learns them in three quarters of the steps, if at all, and is then trained as it predicts.

    Weights that were trained before have statistics, and keep them.
    """
    net, modes, means = NoisyNet(), [], []

    def record(part_indices, rng):
        x = torch.from_numpy(rng.normal(3.0, 2.0, (len(part_indices), 3))).float()
        if net.training:
            modes.append(net.layers[1].training)
        loss = net.layers(x).square().mean()
        means.append(net.layers[1].running_mean.clone())
        return loss

    split = TrainingSplit([0, 1], [2])
    settings = replace(SETTINGS, max_steps=12, val_interval=12)
    train(net, record, split, settings, 0, tmp_path / "checkpoint", starts_trained=starts_trained)
    assert modes == norm_steps * [True] + (12 - norm_steps) * [False]
    assert torch.equal(means[-1], means[-4])
    assert torch.equal(means[-1], torch.zeros(4)) == starts_trained


class Interrupted(Exception):
    """What ends a training early."""


def train_noisy(scratch, stop=None, starts_trained=False):
    """Train a `NoisyNet` with everything drawn anew at every step, or until so many losses."""
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(0)
        net = NoisyNet()
    calls = []

    def noisy(part_indices, rng):
        calls.append(None)
        if len(calls) == stop:
            raise Interrupted
        x = torch.from_numpy(rng.normal(size=(len(part_indices), 3))).float()
        return (net.layers(x)[:, 0] - torch.from_numpy(part_indices) / 5).square().mean()

    settings = replace(SETTINGS, max_steps=12, lr=0.5, val_interval=4, patience=3)
    split, path = TrainingSplit([0, 1, 2], [3, 4], solids=[5, 6]), scratch / "checkpoint"
    result = train(net, noisy, split, settings, 7, path, starts_trained=starts_trained)
    return net, result


# Losses 5 to 8, 13 to 16 and 21 to 24 are validations: in front of, between and within them.
# Of weights that were trained before 1 to 4 are one too, and all others come as much later.
@pytest.mark.parametrize(
    ("stop", "starts_trained"),
    [(1, False), (2, False), (7, False), (9, False), (18, False), (3, True), (6, True), (11, True)],
)
def test_it_goes_on_after_an_interruption_as_if_there_had_been_none(
    tmp_path, monkeypatch, stop, starts_trained
):
    monkeypatch.setattr(training, "CHECKPOINT_S", 0.0)  # a checkpoint after every step
    uninterrupted, result = train_noisy(tmp_path / "whole", starts_trained=starts_trained)
    with pytest.raises(Interrupted):
        train_noisy(tmp_path / "torn", stop, starts_trained)
    assert (tmp_path / "torn" / "checkpoint").exists() == (stop > (5 if starts_trained else 1))
    resumed, again = train_noisy(tmp_path / "torn", starts_trained=starts_trained)
    for name, tensor in uninterrupted.state_dict().items():
        assert tensor.numpy().tobytes() == resumed.state_dict()[name].numpy().tobytes(), name
    assert (result.steps, result.has_converged) == (again.steps, again.has_converged)
    for one, other in (
        (result.train_history, again.train_history),
        (result.val_history, again.val_history),
    ):
        assert one.steps.tobytes() == other.steps.tobytes()
        assert one.loss.tobytes() == other.loss.tobytes()


def test_a_finished_training_is_not_trained_again(tmp_path):
    down = np.arange(10.0)[::-1].tolist()
    number, result = train_scalar(down, tmp_path)
    again, same = train_scalar([], tmp_path)
    assert (number, result.steps) == (again, same.steps)


@pytest.mark.parametrize("wrong", [float("nan"), float("inf")])
@pytest.mark.parametrize("when", ["training", "validation"])
def test_a_loss_that_is_no_number_ends_it_with_a_reason(tmp_path, wrong, when):
    net = ScalarNet()

    def diverging(part_indices, rng):
        calm = net.training != (when == "training") or net.number.item() < way(3)
        return net.number.sum() * (-1.0 if calm else wrong)

    with pytest.raises(ReconstructionFailed, match=rf"{when} loss .* step \d+.*training\.lr"):
        train(net, diverging, TrainingSplit([0], [1]), SETTINGS, 0, tmp_path / "checkpoint")


@pytest.mark.parametrize(
    ("losses", "over"),
    [
        ([1.0, 0.5, 0.4, 0.3, 0.2], False),  # falls to the end
        ([1.0, 0.5, 0.4, 0.3, 0.3], True),
        ([1.0, 0.5, 0.4, 0.3, 0.295], True),  # by less than 2 %
        ([1.0, 0.5, 0.4, 0.3, 0.293], False),  # by more
        ([1.0, 0.2, 0.4, 0.5, 0.9], True),  # rises again
        ([1.0, 0.2, 0.4, 0.5, 0.1], False),  # the best is the last
        ([1.0, 0.0, 0.0, 0.0, 0.0], True),  # nothing is left to gain
        ([1.0], False),  # who knows
    ],
)
def test_settled_is_who_gained_little_in_the_last_fifth(losses, over):
    # the last fifth of 100 steps holds the last of five losses alone
    steps = (100 - 20 * np.arange(len(losses))[::-1]).tolist()
    assert has_converged(steps, losses) == over


names = st.lists(st.text("abcdef", min_size=1, max_size=4), min_size=1, max_size=40, unique=True)
shares = st.floats(0.01, 0.99)


@dataclass(frozen=True)
class OnePart:
    part_id: str
    group: str


def split_ids(part_ids, share):
    """Names to learn from and to validate on, each part being a group."""
    parts = [OnePart(name, name) for name in part_ids]
    return tuple({part_ids[i] for i in some} for some in train_val_split(parts, share))


@given(names, shares)
def test_parts_set_apart_are_a_share_and_never_none_or_all(part_ids, share):
    train_ids, val_ids = split_ids(part_ids, share)
    assert train_ids
    assert val_ids
    if len(part_ids) > 1:
        assert train_ids | val_ids == set(part_ids)
        assert not train_ids & val_ids
        assert len(val_ids) == np.clip(share * len(part_ids), 1, len(part_ids) - 1).round()


@given(names, shares, st.randoms(use_true_random=False))
def test_parts_set_apart_do_not_depend_on_the_order(part_ids, share, random):
    mixed = random.sample(part_ids, len(part_ids))
    assert split_ids(part_ids, share) == split_ids(mixed, share)


@given(names, shares)
def test_one_more_part_moves_at_most_one_other(part_ids, share):
    if len(part_ids) > 2:  # a single part is on both sides
        before, after = split_ids(part_ids[1:], share)[1], split_ids(part_ids, share)[1]
        assert len((before ^ after) - {part_ids[0]}) <= 1


def test_one_part_alone_is_learned_from_and_validated_on():
    assert train_val_split([OnePart("one", "gears")], 0.1) == ([0], [0])


@given(st.lists(st.sampled_from("abcdef"), min_size=2, max_size=40), shares)
def test_a_group_is_validated_on_whole(groups, share):
    """As tests hold out whole families: no net is chosen on what it has seen the like of."""
    parts = [OnePart(str(i), group) for i, group in enumerate(groups)]
    train_ids, val_ids = train_val_split(parts, share)
    assert sorted([*train_ids, *val_ids]) == list(range(len(parts)))
    assert train_ids
    assert val_ids
    train_groups, val_groups = ({groups[i] for i in ids} for ids in (train_ids, val_ids))
    if len(set(groups)) > 1:
        assert not train_groups & val_groups
        last = max(val_groups, key=lambda group: sha256(f"validation/{group}".encode()).hexdigest())
        without_last = sum(groups[i] != last for i in val_ids)  # no group more than are needed
        assert without_last < max(1, round(share * len(groups)))
    else:
        assert len(val_ids) == min(max(1, round(share * len(groups))), len(groups) - 1)


def fit_scalar(scratch, examples, prior):
    """The net's number, all shapes that were learned from, all that were asked, and the state."""
    net, learned, asked = ScalarNet(), set(), set()

    def loss(part_indices, rng):
        (learned if net.training else asked).update(part_indices.tolist())
        return (net.number - 3).abs().sum()

    settings = replace(SETTINGS, max_steps=20, batch_size=4, val_fraction=0.3)
    state = fit_network(net, loss, examples, prior, settings, 0, scratch / "checkpoint", "tiny")
    return net.number.item(), learned, asked, state


def shapes(*names):
    """By name alone: nothing is read of them here."""
    return [Example(name, name, Path("part"), Path("views"), frozenset()) for name in names]


PARTS, SOLIDS = shapes(*"abcd"), shapes(*"uvwxyz")


def test_parts_are_learned_from_and_asked_and_solids_learned_from_alone(tmp_path):
    _, learned, asked, state = fit_scalar(tmp_path, PARTS, Prior(SOLIDS))
    assert len(asked) == 1
    assert learned == set(range(10)) - asked
    assert asked < set(range(4))
    assert state.num_parts == 3


def test_without_parts_solids_are_learned_from_and_asked(tmp_path):
    """That is pretraining."""
    _, learned, asked, state = fit_scalar(tmp_path, [], Prior(SOLIDS))
    assert (len(learned), len(asked), state.num_parts) == (4, 2, 4)
    assert learned | asked == set(range(6))
    assert state.val_history.steps[0] == 0  # weights at random


def test_without_solids_parts_are_learned_from_alone(tmp_path):
    _, learned, asked, state = fit_scalar(tmp_path, PARTS, NO_PRIOR)
    assert (len(learned), len(asked), state.num_parts) == (3, 1, 3)


def test_a_training_starts_from_the_weights_of_its_prior(tmp_path):
    weights = ModelState({"number": np.array([3.0], np.float16)}, num_parts=6)
    number, _, _, state = fit_scalar(tmp_path, PARTS, Prior(SOLIDS, weights))
    assert number == 3  # nothing is better
    assert state.val_history.loss[0] == 0


def test_weights_of_another_size_are_refused_with_the_knob(tmp_path):
    other = ModelState({"weight": np.zeros((3, 5), np.float32)}, num_parts=1, size="cpu")
    with pytest.raises(BadParams, match=r"size 'cpu' and do not fit .*pretrain.weights"):
        fit_network(
            torch.nn.Linear(2, 1, bias=False),
            lambda indices, rng: torch.zeros(()),
            [],
            Prior(weights=other),
            SETTINGS,
            0,
            tmp_path / "checkpoint.pt",
            "cpu",
        )
