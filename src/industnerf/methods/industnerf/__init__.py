"""IndustNeRF, the paper's method: a point cloud with a radiance field that re-renders its views.

The files read as section 3 does:

    3.1  scene, position_encoding, encoder, projection, pooling, source_features, network, field
    3.2  point_levels, density_pdf, refine
    3.3  ray_sampler, losses, optimizer, trainer, rerender
    3.4  confidence, extraction
    all  pipeline, on one part; pretraining, on several; variant, the hooks of `industnerf_plus`

Three more methods are the same code: `industnerf_depth` is given depth maps, which the paper names
as future work; `industnerf_shared` has E and N pretrained on other parts; `nerf` is a baseline of
free densities and colors at the nodes of a grid.
"""

from collections.abc import Callable, Sequence
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
from industnerf.schema import IndustnerfSettings, IndustnerfSharedSettings
from industnerf.seeds import seed_for


def reconstruct(
    inputs: MethodInputs, settings: IndustnerfSettings, state: None, seed: int
) -> Reconstruction:
    """The paper's method, or the plain baseline: from images and cameras alone."""
    return run_on_inputs(_load_run(), inputs, settings, seed)


def reconstruct_depth(
    inputs: MethodInputs, settings: IndustnerfSettings, state: None, seed: int
) -> Reconstruction:
    """The paper's method, given depth maps as well."""
    return run_on_inputs(_load_run(), inputs, settings, seed, depth=inputs.depth_mm)


def fit(
    examples: Sequence[Example], settings: IndustnerfSharedSettings, seed: int, scratch: Path
) -> ModelState:
    """E and N, trained on the images of some of `examples`, which are chosen by hash."""
    from industnerf.methods.industnerf.pretraining import pretrain

    ordered = sorted(examples, key=lambda example: seed_for(0, "school", example.part_id))
    chosen = ordered[: settings.pretraining.parts]
    method = METHODS["industnerf_shared"]
    inputs = [load_inputs(method, example.part, example.views) for example in chosen]
    return pretrain([_posed_images(each) for each in inputs], settings, seed, scratch)


def reconstruct_shared(
    inputs: MethodInputs, settings: IndustnerfSharedSettings, state: ModelState, seed: int
) -> Reconstruction:
    """The paper's method, from E and N that were pretrained on other parts; E is kept."""
    run = partial(_load_run(), pretrained=state.arrays)
    return run_on_inputs(run, inputs, settings, seed)


def _load_run() -> Callable[..., Any]:
    # late: a report that names the method need not wait for torch
    from industnerf.methods.industnerf.pipeline import run

    return run


def _posed_images(
    inputs: MethodInputs, background: np.ndarray | None = None, depth: np.ndarray | None = None
):
    from industnerf.methods.industnerf.scene import PosedImages

    center, radius = common_view_ball(inputs.cameras)
    return PosedImages(inputs.rgb, inputs.cameras, background, center, radius, depth)


def run_on_inputs(
    run: Callable[..., Any],
    inputs: MethodInputs,
    settings: IndustnerfSettings,
    seed: int,
    *,
    background: np.ndarray | None = None,
    depth: np.ndarray | None = None,
) -> Reconstruction:
    """What `pipeline.run`, or that of a variant, makes of a part's declared inputs."""
    result = run(_posed_images(inputs, background, depth), settings, seed)
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
    """Renders the held-out views, over the mean background of the training views."""
    if not len(inputs.held_out):
        return None
    color = result.background if background is None else background
    backgrounds = np.tile(color.mean(0), (len(inputs.held_out), 1))
    return partial(result.render_views, inputs.held_out, backgrounds)


METHODS = {
    "industnerf": Method(
        "industnerf", Scope.PART, frozenset({Input.RGB}), reconstruct, is_stochastic=True
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
