"""Run a method on one part: hand over what it declares, check and keep what it returns."""

from pathlib import Path
from typing import Any

import numpy as np

from industnerf.artifacts.cloud import Cloud
from industnerf.methods.base import Input, Method, hand_over
from industnerf.methods.checks import checked
from industnerf.seeds import seed_for

FILES = {
    Input.RGB: "rgb",
    Input.MASK: "mask",
    Input.DEPTH: "depth",
}


def files_of(method: Method, part: Path, views: Path) -> tuple[Path, ...]:
    """The files that `method` may depend on: its cameras, and what it declares."""
    images = [views / FILES[name] for name in sorted(method.inputs) if name in FILES]
    mesh = [part / "mesh.npz"] if Input.OWN_MESH in method.inputs else []
    return (views / "cameras.json", *images, *mesh)


def reconstruct_part(
    method: Method, part: Path, views: Path, target: Path, *, settings: Any, seed: int
) -> None:
    """Write the cloud of one part into `target`, and whatever else the method returned.

    Raises ReconstructionFailed if the method returns no point, or one that is not finite.
    """
    given = hand_over(method, part, views)
    own_seed = seed_for(seed, "reconstruct", method.name, part.name)
    result = checked(method.reconstruct(given, settings, None, own_seed), given)
    n = len(result.points_mm)
    grey, certain = np.full((n, 3), 128, np.uint8), np.ones(n, np.float32)
    unknown = np.full(n, -1, np.int16)
    Cloud(
        part.name,
        result.points_mm.astype(np.float32),
        grey if result.colours is None else result.colours,
        certain if result.confidence is None else result.confidence.astype(np.float32),
        unknown if result.view is None else result.view.astype(np.int16),
        result.parameters,
        result.steps,
    ).save(target)
    for more in (result.renderings, result.candidates, result.history):
        if more is not None:
            more.save(target)
