"""Colors alone at the end: they come nearer to the photographs, and nothing else moves."""

from dataclasses import replace

import numpy as np
import pytest
import torch

from industnerf.errors import BadValue
from industnerf.methods.industnerf.pipeline import Callback, ReconstructionResult
from industnerf.schema import IndustnerfPlusSettings
from tests.methods.industnerf.results import (
    SOLIDS,
    RecordingCallback,
    make_reconstructor,
    result_bytes,
    run,
)
from tests.methods.industnerf.synthetic_scenes import make_posed_images, settings

PX = 48
LEVELS = [{"steps": 40, "image_px": PX}, {"steps": 0, "image_px": PX}]
TRAIN_IMAGES = make_posed_images(SOLIDS["box"], 16, PX)
HELD_OUT_IMAGES = make_posed_images(SOLIDS["box"], 5, PX)


def make_settings(num_steps: int, **others) -> IndustnerfPlusSettings:
    small = {
        "grid_res": 16,
        "rays_per_step": 512,
        "surface_px": PX,
        "surface_spacing": 0.03,
        "levels": LEVELS,
    }
    return settings(
        "industnerf_plus", **small | others, color_refinement={"steps": num_steps, "lr": 0.05}
    )


def render_held_out(result: ReconstructionResult) -> np.ndarray:
    """Through cameras that were not looked through."""
    return result.render_views(HELD_OUT_IMAGES.cameras, np.ones((len(HELD_OUT_IMAGES.rgb), 3))).rgb


def held_out_mse(result: ReconstructionResult) -> float:
    """Mean squared error of these."""
    return float(((render_held_out(result) / 255.0 - HELD_OUT_IMAGES.rgb / 255.0) ** 2).mean())


@pytest.fixture(scope="module")
def unrefined() -> ReconstructionResult:
    return run(TRAIN_IMAGES, make_settings(0), 1)


@pytest.fixture(scope="module")
def refined() -> tuple[ReconstructionResult, RecordingCallback]:
    callback = RecordingCallback()
    return run(TRAIN_IMAGES, make_settings(30), 1, callback), callback


def test_views_that_nobody_was_given_are_nearer_to_their_photographs(unrefined, refined):
    """By an eighth at least: outlines, which stay as soft as they are, are most of the error."""
    assert held_out_mse(refined[0]) < 0.875 * held_out_mse(unrefined)


def test_the_surface_stays_where_it_is():
    reconstructor = make_reconstructor(TRAIN_IMAGES, make_settings(30), Callback())
    while reconstructor.trainer.level == 0 or not reconstructor.is_finished:
        if reconstructor.trainer.level == 1:
            before = reconstructor.trainer.field.raw.detach().clone()
            colors = reconstructor.trainer.field.rgb.detach().clone()
        reconstructor.train()
        reconstructor.advance_level()
    assert torch.equal(reconstructor.trainer.field.raw, before)
    assert not torch.equal(reconstructor.trainer.field.rgb, colors)


def test_the_cloud_is_what_it_is_without(unrefined, refined):
    for values in ("points", "colors", "confidence", "view", "candidates", "candidate_confidence"):
        np.testing.assert_array_equal(getattr(refined[0], values), getattr(unrefined, values))


def test_its_steps_are_told_and_counted(refined):
    result, callback = refined
    assert callback.started_levels == [("level 0", 40), ("level 1", 0), ("colors", 30)]
    assert result.level_starts == {"level 0": 0, "level 1": 40, "colors": 40}
    assert result.steps == len(callback.losses) == len(callback.previews) == 70
    # ten rounds of 512 rays each: what they differ by from chance is a few percent
    assert np.mean(result.losses[-10:]) < 0.9 * np.mean(result.losses[40:50])


def test_a_run_goes_on_to_the_same_bytes(refined):
    result, callback = refined
    assert len(callback.states) == 40  # none on the way: who goes on takes these steps anew
    for state in (callback.states[20], callback.states[-1]):
        resumed = run(TRAIN_IMAGES, make_settings(30), 1, None, state)
        assert result_bytes(resumed) == result_bytes(result)
        np.testing.assert_array_equal(render_held_out(resumed), render_held_out(result))


def test_without_steps_no_level_starts(unrefined):
    assert unrefined.level_starts == {"level 0": 0, "level 1": 40}


def test_colors_that_a_network_gives_cannot_be_learned_alone():
    config = settings("industnerf_plus")
    sdf = replace(config.sdf, enabled=False, init=replace(config.sdf.init, enabled=False))
    with pytest.raises(BadValue, match=r"color_refinement\.steps"):
        make_settings(1, network={"enabled": True}, sdf=sdf)
