"""A whole run with polish, on photographs of a ball: what it says and where it stops."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import trimesh

from industnerf.geometry.surface_distance import distance_to_surface
from industnerf.methods.industnerf.pipeline import Callback, ReconstructionResult
from industnerf.methods.industnerf.scene import PosedImages
from industnerf.methods.industnerf_plus import pipeline
from industnerf.methods.industnerf_plus.finishes import FinishFit
from industnerf.methods.industnerf_plus.rerender import render_views
from tests.methods.industnerf.synthetic_scenes import settings
from tests.methods.industnerf_plus.test_polish import CAMERAS, LIGHT, VIEWS, ball, make_surface

TRAINING_STEPS, POLISH_STEPS = 10, 6
POLISH = {
    "enabled": True,
    "max_nodes": 40_000,
    "steps": POLISH_STEPS,
    "rays_per_step": 256,
    "light_pixels": 2000,
    "points": 2000,
}


@pytest.fixture(scope="module")
def posed() -> PosedImages:
    surface = make_surface(ball())
    surface.set_finishes(FinishFit(LIGHT, np.ones(1), np.zeros(0, np.int64), 0.0, 0.0))
    background = np.ones((VIEWS, 3))
    images = render_views(surface, np.zeros(3), 1.0, CAMERAS, background)
    return PosedImages(images.rgb, CAMERAS, background, np.zeros(3), 1.0)


class Recorder(Callback):
    """Keeps warnings; asks for a checkpoint after so many steps, and stops there."""

    def __init__(self, stop_after: int = 0) -> None:
        self.warnings: list[str] = []
        self.state: dict[str, Any] = {}
        self._num_steps, self._stop_after = 0, stop_after

    def on_warning(self, message: str) -> None:
        self.warnings.append(message)

    def on_step_end(self, loss) -> None:
        self._num_steps += 1

    def wants_checkpoint(self) -> bool:
        return self._num_steps == self._stop_after

    def on_checkpoint(self, state: dict[str, Any]) -> None:
        self.state = state
        raise KeyboardInterrupt


def run(
    posed: PosedImages,
    callback: Callback | None = None,
    resume: dict[str, Any] | None = None,
    **polish: Any,
) -> ReconstructionResult:
    config = settings("industnerf_plus", max_grid_points=0, polish=POLISH | polish)
    return pipeline.run(posed, config, 0, callback, resume)


def test_without_steps_of_polish_no_light_is_missed(posed):
    recorder = Recorder()
    result = run(posed, recorder, steps=0)
    assert not recorder.warnings
    assert not result.warnings
    assert len(result.points)
    assert list(result.level_starts) == ["level 0"]


def test_pixels_too_few_for_light_are_not_blamed_on_the_light(posed):
    """The part is so small in the photographs that all of its pixels are beside its outline."""
    K = CAMERAS.K.copy()
    K[:, :2] /= 6
    coarse = posed.rgb.reshape(VIEWS, 16, 6, 16, 6, 3).mean(axis=(2, 4)).round().astype(np.uint8)
    small = replace(posed, rgb=coarse, cameras=replace(CAMERAS, K=K, width=16, height=16))
    recorder = Recorder()
    result = run(small, recorder)
    assert recorder.warnings == [pipeline.FEW_PIXELS_WARNING] == list(result.warnings)


def test_a_run_that_is_stopped_in_the_polish_resumes_before_it(posed):
    whole = run(posed)
    assert whole.steps == TRAINING_STEPS + POLISH_STEPS
    recorder = Recorder(stop_after=TRAINING_STEPS + 2)
    with pytest.raises(KeyboardInterrupt):
        run(posed, recorder)
    assert len(recorder.state["losses"]) == TRAINING_STEPS
    assert list(recorder.state["level_starts"]) == ["level 0"]
    resumed = run(posed, resume=recorder.state)
    assert resumed.losses == whole.losses
    assert resumed.level_starts == whole.level_starts
    np.testing.assert_array_equal(resumed.points, whole.points)
    np.testing.assert_array_equal(resumed.confidence, whole.confidence)


def test_the_mesh_is_the_surface_that_the_cloud_is_of(posed):
    result = run(posed)
    vertices, faces = result.mesh()
    mesh = trimesh.Trimesh(vertices, faces, process=False)
    assert mesh.is_watertight
    assert mesh.volume > 0
    distance = distance_to_surface(result.points.astype(np.float64), vertices, faces)
    # a triangle beside a node that is moved off 0 may be split the other way
    assert np.quantile(distance, 0.98) < 1e-3
    assert distance.max() < 0.02
