"""Run a method: give it what it declares, check and save what it returns."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from industnerf.artifacts.cloud import Cloud, save_extra_clouds, save_warnings
from industnerf.artifacts.state import ModelState
from industnerf.artifacts.views import ARCHIVE, CAMERAS
from industnerf.errors import BadParams, ReconstructionFailed
from industnerf.learning.procedural_shapes import load_procedural_shapes
from industnerf.learning.training_shape import Prior
from industnerf.methods.base import (
    Example,
    Input,
    Method,
    MethodInputs,
    Reconstruction,
    load_inputs,
)
from industnerf.methods.checks import check_reconstruction, check_renderings
from industnerf.seeds import seed_for
from industnerf.timing import Timing

WEIGHTS = "weights"  # the name of the one result of a pretraining
FILES = {Input.RGB: "rgb", Input.MASK: "mask", Input.DEPTH: "depth"}


def input_files(method: Method, part: Path, views: Path) -> tuple[Path, ...]:
    """The files that `method` may depend on: its cameras, and what it declares.

    Photographs are members of their archive: what a method does not declare changes no key of its.
    """
    photographs = views / ARCHIVE
    images = [photographs / FILES[name] for name in sorted(method.inputs) if name in FILES]
    mesh = [part / "mesh.npz"] if method.inputs & {Input.OWN_MESH, Input.PART_FRAME} else []
    return (photographs / CAMERAS, *images, *mesh)


def training_files(example: Example) -> tuple[Path, ...]:
    """The files of `example` that what is learned from it may depend on."""
    images = [example.views / ARCHIVE / name for name in (CAMERAS, "rgb")]
    mesh = [example.part / "mesh.npz"] if Input.OTHER_MESHES in example.inputs else []
    return (*(images if Input.RGB in example.inputs else []), *mesh)


@dataclass(frozen=True)
class PriorSource:
    """Where it is read from what a network brings along."""

    weights: Path | None  # the folder of pretrained weights
    procedural: Path  # the folder of the procedural solids ...
    chunks: Sequence[str]  # ... and which of its chunks
    held_out: Sequence[str] = ()  # families that no solid may resemble

    def load(self) -> Prior:
        """Read the weights, if there are any, and the solids."""
        solids = load_procedural_shapes(self.procedural, self.chunks)
        return Prior(
            [solid for solid in solids if solid.resembles not in self.held_out],
            None if self.weights is None else ModelState.load(self.weights),
        )


def fit_method(
    method: Method,
    examples: Sequence[Example],
    target: Path,
    *,
    settings: Any,
    seed: int,
    scratch: Path,
    prior: PriorSource | None = None,
) -> None:
    """Write into `target` what `method` learns from `examples`; `scratch` is to resume from.

    Of a method that declares no procedural solids `prior` is None.

    Raises ReconstructionFailed if there is nothing to learn from.
    """
    if not examples:
        raise ReconstructionFailed(
            "no part is left to learn from: all are held out together (split.hold_out, split.folds)"
        )
    method_seed = seed_for(seed, "fit", method.name)
    more = () if prior is None else (prior.load(),)
    method.fit(examples, settings, method_seed, scratch, *more).save(target)


def pretrain_method(
    method: Method,
    procedural: Path,
    chunks: Sequence[str],
    target: Path,
    *,
    settings: Any,
    seed: int,
    scratch: Path,
) -> None:
    """Write into `target` what `method` learns from the procedural solids of `chunks` alone.

    Solids that resemble a family of the study are left out: all folds start from these weights.

    Raises BadParams if no other is left.
    """
    solids = load_procedural_shapes(procedural, chunks)
    abstract = [solid for solid in solids if solid.resembles is None]
    if not abstract:
        raise BadParams(
            f"all {len(solids)} procedural solids resemble a family of the study, and a "
            "pretraining leaves these out: raise procedural.solids, or set procedural.kinds to "
            "abstract"
        )
    method_seed = seed_for(seed, "pretrain", method.name)
    method.fit((), settings, method_seed, scratch, Prior(abstract)).save(target)


def copy_weights(source: Path, target: Path) -> None:
    """Copy a state that `pretrain_method` wrote, from the folder `source`."""
    ModelState.load(source).save(target)


def reconstruct_part(
    method: Method,
    part: Path,
    views: Path,
    state: Path | None,
    target: Path,
    *,
    settings: Any,
    seed: int,
    num_views: int = 0,
) -> Timing:
    """Write the cloud of one part into `target`, and whatever else the method returned.

    `state` is the folder of what the method has learned from other parts; `num_views` is how many
    of the training views it is given, 0: all.  Returns the time that rendering the held-out
    views took: Table 2 needs these renderings, a reconstruction does not.

    Raises ReconstructionFailed if the method returns no point, or one that is not finite.
    """
    inputs = load_inputs(method, part, views, num_views)
    method_seed = seed_for(seed, "reconstruct", method.name, part.name)
    loaded_state = None if state is None else ModelState.load(state)
    result = check_reconstruction(
        method.reconstruct(inputs, settings, loaded_state, method_seed), inputs
    )
    _cloud(part.name, result, inputs).save(target)
    if result.warnings:
        save_warnings(target, result.warnings)
    if result.extra_clouds_mm:
        save_extra_clouds(target, result.extra_clouds_mm)
    for artifact in (result.candidates, result.history):
        if artifact is not None:
            artifact.save(target)
    start = Timing.now()
    if result.render is not None:
        check_renderings(result.render(), inputs).save(target)
    return Timing.now() - start


def _cloud(part_id: str, result: Reconstruction, inputs: MethodInputs) -> Cloud:
    """Gray, certain and of unknown view where the method does not say."""
    n = len(result.points_mm)
    default_color, default_confidence = np.full((n, 3), 128, np.uint8), np.ones(n, np.float32)
    view = np.full(n, -1) if result.view is None else result.view
    if inputs.view_indices is not None:  # a point names its view as the photographs are numbered
        view = np.where(view >= 0, inputs.view_indices[view], -1)
    return Cloud(
        part_id,
        result.points_mm.astype(np.float32),
        default_color if result.colors is None else result.colors,
        default_confidence if result.confidence is None else result.confidence.astype(np.float32),
        view.astype(np.int16),
        result.num_parameters,
        result.steps,
    )
