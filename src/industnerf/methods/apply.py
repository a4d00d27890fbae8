"""Run a method: hand over what it declares, check and keep what it returns."""

import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from industnerf.artifacts.cloud import Cloud, save_others, save_remarks
from industnerf.artifacts.state import State
from industnerf.errors import ReconstructionFailed
from industnerf.methods.base import Example, Given, Input, Method, Reconstruction, hand_over
from industnerf.methods.checks import checked, checked_renderings
from industnerf.seeds import seed_for

FILES = {
    Input.RGB: "rgb",
    Input.MASK: "mask",
    Input.DEPTH: "depth",
}


def files_of(method: Method, part: Path, views: Path) -> tuple[Path, ...]:
    """The files that `method` may depend on: its cameras, and what it declares."""
    images = [views / FILES[name] for name in sorted(method.inputs) if name in FILES]
    mesh = [part / "mesh.npz"] if method.inputs & {Input.OWN_MESH, Input.FRAME} else []
    return (views / "cameras.json", *images, *mesh)


def files_to_learn_from(example: Example) -> tuple[Path, ...]:
    """The files of `example` that what is learned from it may depend on."""
    images = [example.views / "cameras.json", example.views / "rgb"]
    mesh = [example.part / "mesh.npz"] if Input.OTHER_MESHES in example.inputs else []
    return (*(images if Input.RGB in example.inputs else []), *mesh)


def learn(
    method: Method,
    examples: Sequence[Example],
    target: Path,
    *,
    settings: Any,
    seed: int,
    scratch: Path,
) -> None:
    """Write into `target` what `method` learns from `examples`; `scratch` is to resume from.

    Raises ReconstructionFailed if there is nothing to learn from.
    """
    if not examples:
        raise ReconstructionFailed(
            "no part is left to learn from: all are held out together (split.hold_out, split.folds)"
        )
    own_seed = seed_for(seed, "fit", method.name)
    method.fit(examples, settings, own_seed, scratch).save(target)


def reconstruct_part(
    method: Method,
    part: Path,
    views: Path,
    state: Path | None,
    target: Path,
    *,
    settings: Any,
    seed: int,
    count: int = 0,
) -> float:
    """Write the cloud of one part into `target`, and whatever else the method returned.

    `state` is the folder of what the method has learned from other parts; `count` is how many of
    the training views it is given, 0: all.  Returns the seconds that the pictures of the held-out
    views took: Table 2 asks for them, a reconstruction does not.

    Raises ReconstructionFailed if the method returns no point, or one that is not finite.
    """
    given = hand_over(method, part, views, count)
    own_seed = seed_for(seed, "reconstruct", method.name, part.name)
    learned = None if state is None else State.load(state)
    result = checked(method.reconstruct(given, settings, learned, own_seed), given)
    _cloud(part.name, result, given).save(target)
    if result.remarks:
        save_remarks(target, result.remarks)
    if result.others_mm:
        save_others(target, result.others_mm)
    for more in (result.candidates, result.history):
        if more is not None:
            more.save(target)
    start = time.perf_counter()
    if result.render is not None:
        checked_renderings(result.render(), given).save(target)
    return time.perf_counter() - start


def _cloud(part_id: str, result: Reconstruction, given: Given) -> Cloud:
    """Grey, certain and of unknown view where the method does not say."""
    n = len(result.points_mm)
    grey, certain = np.full((n, 3), 128, np.uint8), np.ones(n, np.float32)
    view = np.full(n, -1) if result.view is None else result.view
    if given.chosen is not None:  # a point names its view as the photographs are numbered
        view = np.where(view >= 0, given.chosen[view], -1)
    return Cloud(
        part_id,
        result.points_mm.astype(np.float32),
        grey if result.colours is None else result.colours,
        certain if result.confidence is None else result.confidence.astype(np.float32),
        view.astype(np.int16),
        result.parameters,
        result.steps,
    )
