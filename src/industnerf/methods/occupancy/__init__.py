"""Occupancy Networks: whether a point is inside the part, given one photograph of it.

Mescheder et al., "Occupancy Networks: Learning 3D Reconstruction in Function Space" (2019), with
its released code.  `network` is the net, `lesson` what it is taught, `mise` how a surface is found
in what it says.  The encoder starts at random: published weights cannot be had offline.
"""

from collections.abc import Sequence
from pathlib import Path

from industnerf.artifacts.state import ModelState
from industnerf.methods.base import Example, Input, Method, MethodInputs, Reconstruction, Scope
from industnerf.schema import OccupancySettings


def fit(
    examples: Sequence[Example], settings: OccupancySettings, seed: int, scratch: Path
) -> ModelState:
    """The weights that are best on the validation parts."""
    # late: a report that names the method need not wait for torch
    from industnerf.methods.occupancy.run import fit

    return fit(examples, settings, seed, scratch)


def reconstruct(
    inputs: MethodInputs, settings: OccupancySettings, state: ModelState, seed: int
) -> Reconstruction:
    """One answer for each of `settings.answers` views: points of the surface that it shows."""
    from industnerf.methods.occupancy.run import reconstruct

    return reconstruct(inputs, settings, state, seed)


METHODS = {
    "occupancy": Method(
        "occupancy",
        Scope.DATASET,
        frozenset({Input.RGB, Input.PART_FRAME, Input.OTHER_MESHES}),
        reconstruct,
        fit,
        is_stochastic=True,
    )
}
