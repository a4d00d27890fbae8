"""IndustNeRF, the paper's method: a point cloud whose radiance re-renders the source views.

`industnerf` is the paper; `industnerf_plus` the same code with other settings, which also takes
the background's color; `industnerf_depth` is given depth beside the images, which the paper names
as future work; `industnerf_shared` has an E that learned from other parts; `nerf` is a baseline,
again with other settings: free densities and colors at the nodes of a grid.  The flow of figure 2,
a file a step: levels (3.1, 3.2), sources and field (4), training (3.3), witnesses and extraction
(3.4); `run` strings them together.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from industnerf.artifacts.candidates import Candidates
from industnerf.artifacts.history import History
from industnerf.artifacts.renderings import Renderings
from industnerf.artifacts.state import ModelState
from industnerf.geometry.cameras import common_view_ball
from industnerf.methods.base import (
    Example,
    Input,
    Method,
    MethodInputs,
    Reconstruction,
    Scope,
    load_inputs,
)
from industnerf.schema import IndustnerfSettings
from industnerf.seeds import seed_for


def reconstruct(
    inputs: MethodInputs, settings: IndustnerfSettings, state: None, seed: int
) -> Reconstruction:
    """The paper's method, or the plain baseline: images and cameras, nothing else."""
    return _reconstruct(inputs, settings, seed)


def reconstruct_plus(
    inputs: MethodInputs, settings: IndustnerfSettings, state: None, seed: int
) -> Reconstruction:
    """The same, told of the color behind the part."""
    return _reconstruct(inputs, settings, seed, background=inputs.background)


def reconstruct_depth(
    inputs: MethodInputs, settings: IndustnerfSettings, state: None, seed: int
) -> Reconstruction:
    """The paper's method, given depth as well."""
    return _reconstruct(inputs, settings, seed, depth=inputs.depth_mm)


def fit(
    examples: Sequence[Example], settings: IndustnerfSettings, seed: int, scratch: Path
) -> ModelState:
    """E and N's start, from the images of some of `examples`: by hash, whatever they look like."""
    from industnerf.methods.industnerf.pretraining import pretrain

    ordered = sorted(examples, key=lambda example: seed_for(0, "school", example.part_id))
    chosen = ordered[: settings.pretraining.parts]
    inputs = [
        load_inputs(METHODS["industnerf_shared"], example_inputs.part, example_inputs.views)
        for example_inputs in chosen
    ]
    return pretrain(
        [_posed_images(example_inputs) for example_inputs in inputs], settings, seed, scratch
    )


def reconstruct_shared(
    inputs: MethodInputs, settings: IndustnerfSettings, state: ModelState, seed: int
) -> Reconstruction:
    """The paper's method with an E that has learned from other parts, and N's start."""
    return _reconstruct(inputs, settings, seed, pretrained=state.arrays)


def _posed_images(
    inputs: MethodInputs, background: np.ndarray | None = None, depth: np.ndarray | None = None
):
    from industnerf.methods.industnerf.scene import PosedImages

    center, radius = common_view_ball(inputs.cameras)
    return PosedImages(inputs.rgb, inputs.cameras, background, center, radius, depth)


def _reconstruct(
    inputs: MethodInputs,
    settings: IndustnerfSettings,
    seed: int,
    *,
    background: np.ndarray | None = None,
    depth: np.ndarray | None = None,
    pretrained: Mapping[str, np.ndarray] | None = None,
) -> Reconstruction:
    # late: a report that names the method need not wait for torch
    from industnerf.methods.industnerf.pipeline import run

    result = run(_posed_images(inputs, background, depth), settings, seed, pretrained=pretrained)
    return Reconstruction(
        result.points.astype(np.float64),
        result.colors,
        result.confidence.astype(np.float64),
        num_parameters=result.num_parameters,
        steps=result.steps,
        view=result.view,
        render=_held_out_renderer(inputs, result, background),
        candidates=Candidates(result.candidates, result.candidate_confidence),
        history=History(
            np.arange(result.steps), np.array(result.losses, float), result.level_starts
        ),
        warnings=result.warnings,
    )


def _held_out_renderer(
    inputs: MethodInputs, result: Any, background: np.ndarray | None
) -> Callable[[], Renderings] | None:
    """Draws the views that nobody was given, before the mean of the backgrounds that are known."""
    if not len(inputs.held_out):
        return None
    color = result.background if background is None else background
    backgrounds = np.tile(color.mean(0), (len(inputs.held_out), 1))
    return partial(result.render_views, inputs.held_out, backgrounds)


METHODS = {
    "industnerf": Method(
        "industnerf", Scope.PART, frozenset({Input.RGB}), reconstruct, is_stochastic=True
    ),
    "industnerf_plus": Method(
        "industnerf_plus",
        Scope.PART,
        frozenset({Input.RGB, Input.BACKGROUND}),
        reconstruct_plus,
        is_stochastic=True,
    ),
    "industnerf_depth": Method(
        "industnerf_depth",
        Scope.PART,
        frozenset({Input.RGB, Input.DEPTH}),
        reconstruct_depth,
        is_stochastic=True,
    ),
    "industnerf_shared": Method(
        "industnerf_shared",
        Scope.DATASET,
        frozenset({Input.RGB}),
        reconstruct_shared,
        fit,
        is_stochastic=True,
    ),
    "nerf": Method("nerf", Scope.PART, frozenset({Input.RGB}), reconstruct, is_stochastic=True),
}
