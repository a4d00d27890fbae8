"""Colours alone at the end: they come nearer to the photographs, and nothing else moves."""

from dataclasses import replace

import numpy as np
import pytest
import torch

from industnerf.errors import BadValue
from industnerf.methods.industnerf.run import Outcome, Watch, Work, run
from industnerf.schema import IndustnerfSettings
from tests.methods.industnerf.outcomes import SOLIDS, Recorder, bytes_of
from tests.methods.industnerf.scenes import posed, settings

PX = 48
LEVELS = [{"steps": 40, "image_px": PX}, {"steps": 0, "image_px": PX}]
GIVEN = posed(SOLIDS["box"], 16, PX)
UNSEEN = posed(SOLIDS["box"], 5, PX)


def ways(steps: int, **others) -> IndustnerfSettings:
    few = {"grid_res": 16, "rays": 512, "surface_px": PX, "spacing": 0.03, "levels": LEVELS}
    return settings("industnerf_plus", **few | others, recolour={"steps": steps, "rate": 0.05})


def pictures(outcome: Outcome) -> np.ndarray:
    """Through cameras that were not looked through."""
    return outcome.pictures(UNSEEN.cameras, np.ones((len(UNSEEN.rgb), 3))).rgb


def off(outcome: Outcome) -> float:
    """Mean squared error of these."""
    return float(((pictures(outcome) / 255.0 - UNSEEN.rgb / 255.0) ** 2).mean())


@pytest.fixture(scope="module")
def without() -> Outcome:
    return run(GIVEN, ways(0), 1)


@pytest.fixture(scope="module")
def told() -> tuple[Outcome, Recorder]:
    watch = Recorder()
    return run(GIVEN, ways(30), 1, watch), watch


def test_views_that_nobody_was_given_are_nearer_to_their_photographs(without, told):
    """By an eighth at least: outlines, which stay as soft as they are, are most of the error."""
    assert off(told[0]) < 0.875 * off(without)


def test_the_surface_stays_where_it_is():
    work = Work(GIVEN, ways(30), 1, Watch())
    while work.training.level == 0 or not work.finished:
        if work.training.level == 1:
            before = work.training.field.raw.detach().clone()
            colours = work.training.field.rgb.detach().clone()
        work.train()
        work.listen()
    assert torch.equal(work.training.field.raw, before)
    assert not torch.equal(work.training.field.rgb, colours)


def test_the_cloud_is_what_it_is_without(without, told):
    for values in ("points", "colours", "confidence", "view", "candidates", "certainty"):
        np.testing.assert_array_equal(getattr(told[0], values), getattr(without, values))


def test_its_steps_are_told_and_counted(told):
    outcome, watch = told
    assert watch.begun == [("level 0", 40), ("level 1", 0), ("colours", 30)]
    assert outcome.first_steps == {"level 0": 0, "level 1": 40, "colours": 40}
    assert outcome.steps == len(watch.losses) == len(watch.seen) == 70
    # ten rounds of 512 rays each: what they differ by from chance is a few percent
    assert np.mean(outcome.losses[-10:]) < 0.9 * np.mean(outcome.losses[40:50])


def test_a_run_goes_on_to_the_same_bytes(told):
    outcome, watch = told
    assert len(watch.states) == 40  # none on the way: who goes on takes these steps anew
    for state in (watch.states[20], watch.states[-1]):
        resumed = run(GIVEN, ways(30), 1, None, state)
        assert bytes_of(resumed) == bytes_of(outcome)
        np.testing.assert_array_equal(pictures(resumed), pictures(outcome))


def test_without_steps_nothing_is_begun(without):
    assert without.first_steps == {"level 0": 0, "level 1": 40}


def test_colours_that_a_network_gives_cannot_be_learned_alone():
    taught = settings("industnerf")
    with pytest.raises(BadValue, match=r"recolour\.steps"):
        replace(taught, recolour=replace(taught.recolour, steps=1))
