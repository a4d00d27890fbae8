"""E and N's start from other parts: what is learned, kept, resumed, and used."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import torch

from industnerf.artifacts.state import ModelState
from industnerf.learning.weights import load_arrays, state_arrays
from industnerf.methods.industnerf import pretraining
from industnerf.methods.industnerf.field import Field, SharedModules
from industnerf.methods.industnerf.pipeline import run
from industnerf.methods.industnerf.pretraining import pretrain
from industnerf.schema import IndustnerfSharedSettings, PretrainingSettings
from tests.methods.industnerf.synthetic_scenes import (
    ball,
    box,
    make_posed_images,
    make_test_scene,
    settings,
    translate,
)

TRAINING_SOLIDS = (ball(18.0), box((16.0, 11.0, 8.0)))


def make_settings(epochs: int = 3, steps: int = 8) -> IndustnerfSharedSettings:
    return settings(
        "industnerf_shared",
        grid_res=16,
        warm_up={"steps": steps, "image_px": 32},
        pretraining=PretrainingSettings(2, epochs),
        levels=[{"steps": 4}],
    )


def training_parts() -> list:
    return [make_posed_images(solid, 6, 32, None) for solid in TRAINING_SOLIDS]


@pytest.fixture
def learn(tmp_path: Path) -> Callable[..., ModelState]:
    def learn(epochs: int = 3, seed: int = 1, scratch: Path = tmp_path) -> ModelState:
        return pretrain(training_parts(), make_settings(epochs), seed, scratch)

    return learn


def same_weights(a: ModelState, b: ModelState) -> bool:
    return all(np.array_equal(a.arrays[name], b.arrays[name]) for name in a.arrays)


def test_epochs_make_all_parts_better(learn):
    state = learn()
    epoch_losses = state.train_history.loss.reshape(3, 8)
    assert epoch_losses[2].mean() < 0.7 * epoch_losses[0].mean()
    assert (state.num_parts, state.steps) == (2, 24)
    assert state.train_history.levels == {"epoch 0": 0, "epoch 1": 8, "epoch 2": 16}
    assert state.num_parameters == sum(array.size for array in state.arrays.values())


def test_pretraining_goes_on_after_its_last_epoch_to_the_same_bytes(learn, tmp_path, monkeypatch):
    other_folder = tmp_path / "not" / "yet" / "there"
    complete = learn(scratch=other_folder)
    learn(2)
    calls = []
    train_epoch = pretraining._train_epoch
    monkeypatch.setattr(pretraining, "_train_epoch", lambda *a: calls.append(1) or train_epoch(*a))
    assert same_weights(learn(), complete)
    assert len(calls) == 1
    third = tmp_path / "third"
    third.mkdir()
    assert not same_weights(learn(seed=2, scratch=third), complete)


def test_a_part_starts_from_what_was_learned_and_keeps_e(learn):
    """A third solid: at its first step it is re-rendered better than by a net that knows none."""
    state, unseen = learn(), make_posed_images(translate(ball(12.0), (5.0, 0.0, -3.0)), 6, 32, None)
    pretrained = run(unseen, make_settings(), 1, pretrained=state.arrays)
    untrained = run(unseen, make_settings(), 1)
    assert pretrained.losses[0] < 0.8 * untrained.losses[0]
    network_size = sum(array.size for name, array in state.arrays.items() if name[:7] == "network")
    assert pretrained.num_parameters == network_size  # E is not learned for the part


def test_shared_modules_take_over_all_weights_of_others():
    torch.manual_seed(0)
    a, b = (
        SharedModules(Field(make_test_scene(ball(18.0), 3, 16), make_settings())) for _ in range(2)
    )
    with torch.no_grad():
        a.network.head.bias += 1
    load_arrays(b, state_arrays(a))
    assert all(torch.equal(x, y) for x, y in zip(a.parameters(), b.parameters(), strict=True))
