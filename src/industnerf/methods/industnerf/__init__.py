"""IndustNeRF, the paper's method: a point cloud whose radiance re-renders the source views.

`industnerf` is the paper; `industnerf_plus` the same code with other settings, which also takes
the background's colour; `industnerf_depth` is given depth beside the images, which the paper names
as future work; `industnerf_shared` has an E that learned from other parts; `nerf` is a baseline,
again with other settings: free densities and colours at the nodes of a grid.  The flow of figure 2,
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
from industnerf.artifacts.state import State
from industnerf.geometry.cameras import framed_ball
from industnerf.methods.base import (
    Example,
    Given,
    Input,
    Method,
    Reconstruction,
    Scope,
    hand_over,
)
from industnerf.schema import IndustnerfSettings
from industnerf.seeds import seed_for


def reconstruct(
    given: Given, settings: IndustnerfSettings, state: None, seed: int
) -> Reconstruction:
    """The paper's method, or the plain baseline: images and cameras, nothing else."""
    return _reconstruct(given, settings, seed)


def reconstruct_plus(
    given: Given, settings: IndustnerfSettings, state: None, seed: int
) -> Reconstruction:
    """The same, told of the colour behind the part."""
    return _reconstruct(given, settings, seed, background=given.background)


def reconstruct_depth(
    given: Given, settings: IndustnerfSettings, state: None, seed: int
) -> Reconstruction:
    """The paper's method, given depth as well."""
    return _reconstruct(given, settings, seed, depth=given.depth_mm)


def fit(
    examples: Sequence[Example], settings: IndustnerfSettings, seed: int, scratch: Path
) -> State:
    """E and N's start, from the images of some of `examples`: by hash, whatever they look like."""
    from industnerf.methods.industnerf.school import schooled

    order = sorted(examples, key=lambda example: seed_for(0, "school", example.part_id))
    chosen = order[: settings.school.parts]
    given = [hand_over(METHODS["industnerf_shared"], one.part, one.views) for one in chosen]
    return schooled([_posed(one) for one in given], settings, seed, scratch)


def reconstruct_shared(
    given: Given, settings: IndustnerfSettings, state: State, seed: int
) -> Reconstruction:
    """The paper's method with an E that has learned from other parts, and N's start."""
    return _reconstruct(given, settings, seed, learned=state.arrays)


def _posed(given: Given, background: np.ndarray | None = None, depth: np.ndarray | None = None):
    from industnerf.methods.industnerf.scene import Posed

    centre, radius = framed_ball(given.cameras)
    return Posed(given.rgb, given.cameras, background, centre, radius, depth)


def _reconstruct(
    given: Given,
    settings: IndustnerfSettings,
    seed: int,
    *,
    background: np.ndarray | None = None,
    depth: np.ndarray | None = None,
    learned: Mapping[str, np.ndarray] | None = None,
) -> Reconstruction:
    # late: a report that names the method need not wait for torch
    from industnerf.methods.industnerf.run import run

    outcome = run(_posed(given, background, depth), settings, seed, learned=learned)
    return Reconstruction(
        outcome.points.astype(np.float64),
        outcome.colours,
        outcome.confidence.astype(np.float64),
        parameters=outcome.parameters,
        steps=outcome.steps,
        view=outcome.view,
        render=_held_out(given, outcome, background),
        candidates=Candidates(outcome.candidates, outcome.certainty),
        history=History(
            np.arange(outcome.steps), np.array(outcome.losses, float), outcome.first_steps
        ),
        remarks=outcome.remarks,
    )


def _held_out(
    given: Given, outcome: Any, background: np.ndarray | None
) -> Callable[[], Renderings] | None:
    """Draws the views that nobody was given, before the mean of the backgrounds that are known."""
    if not len(given.held_out):
        return None
    behind = outcome.background if background is None else background
    every = np.tile(behind.mean(0), (len(given.held_out), 1))
    return partial(outcome.pictures, given.held_out, every)


METHODS = {
    "industnerf": Method(
        "industnerf", Scope.PART, frozenset({Input.RGB}), reconstruct, random=True
    ),
    "industnerf_plus": Method(
        "industnerf_plus",
        Scope.PART,
        frozenset({Input.RGB, Input.BACKGROUND}),
        reconstruct_plus,
        random=True,
    ),
    "industnerf_depth": Method(
        "industnerf_depth",
        Scope.PART,
        frozenset({Input.RGB, Input.DEPTH}),
        reconstruct_depth,
        random=True,
    ),
    "industnerf_shared": Method(
        "industnerf_shared",
        Scope.DATASET,
        frozenset({Input.RGB}),
        reconstruct_shared,
        fit,
        random=True,
    ),
    "nerf": Method("nerf", Scope.PART, frozenset({Input.RGB}), reconstruct, random=True),
}
