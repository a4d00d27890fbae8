"""E and N's start from other parts: what is learned, kept, resumed, and used."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import torch

from industnerf.artifacts.state import State
from industnerf.learning.weights import arrays_of, load_arrays
from industnerf.methods.industnerf import school
from industnerf.methods.industnerf.field import Field
from industnerf.methods.industnerf.pair import Pair
from industnerf.methods.industnerf.run import run
from industnerf.methods.industnerf.school import schooled
from industnerf.schema import IndustnerfSettings, SchoolSettings
from tests.methods.industnerf.scenes import ball, box, moved, posed, scene, settings

PUPILS = (ball(18.0), box((16.0, 11.0, 8.0)))


def ways(terms: int = 3, steps: int = 8) -> IndustnerfSettings:
    return settings(
        "industnerf_shared",
        grid_res=16,
        warm_up={"steps": steps, "image_px": 32},
        school=SchoolSettings(2, terms),
        levels=[{"steps": 4}],
    )


def pupils() -> list:
    return [posed(solid, 6, 32, None) for solid in PUPILS]


@pytest.fixture
def learn(tmp_path: Path) -> Callable[..., State]:
    def learn(terms: int = 3, seed: int = 1, scratch: Path = tmp_path) -> State:
        return schooled(pupils(), ways(terms), seed, scratch)

    return learn


def same(a: State, b: State) -> bool:
    return all(np.array_equal(a.arrays[name], b.arrays[name]) for name in a.arrays)


def test_terms_make_the_parts_alike_better(learn):
    state = learn()
    terms = state.history.loss.reshape(3, 8)
    assert terms[2].mean() < 0.7 * terms[0].mean()
    assert (state.parts, state.steps) == (2, 24)
    assert state.history.levels == {"term 0": 0, "term 1": 8, "term 2": 16}
    assert state.parameters == sum(array.size for array in state.arrays.values())


def test_a_school_goes_on_after_its_last_term_to_the_same_bytes(learn, tmp_path, monkeypatch):
    other = tmp_path / "not" / "yet" / "there"
    whole = learn(scratch=other)
    learn(2)
    taught = []
    term = school._term
    monkeypatch.setattr(school, "_term", lambda *a: taught.append(1) or term(*a))
    assert same(learn(), whole)
    assert len(taught) == 1
    third = tmp_path / "third"
    third.mkdir()
    assert not same(learn(seed=2, scratch=third), whole)


def test_a_part_starts_from_what_was_learned_and_keeps_e(learn):
    """A third solid: at its first step it is re-rendered better than by a net that knows none."""
    state, unseen = learn(), posed(moved(ball(12.0), (5.0, 0.0, -3.0)), 6, 32, None)
    taught = run(unseen, ways(), 1, learned=state.arrays)
    untaught = run(unseen, ways(), 1)
    assert taught.losses[0] < 0.8 * untaught.losses[0]
    network = sum(array.size for name, array in state.arrays.items() if name[:7] == "network")
    assert taught.parameters == network  # E is not learned for the part


def test_a_pair_takes_over_all_weights_of_another():
    torch.manual_seed(0)
    a, b = (Pair(Field(scene(ball(18.0), 3, 16), ways())) for _ in range(2))
    with torch.no_grad():
        a.network.head.bias += 1
    load_arrays(b, arrays_of(a))
    assert all(torch.equal(x, y) for x, y in zip(a.parameters(), b.parameters(), strict=True))
