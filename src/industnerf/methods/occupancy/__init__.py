"""Occupancy Networks: whether a point is inside the part, given one photograph of it.

Mescheder et al., "Occupancy Networks: Learning 3D Reconstruction in Function Space" (2019), with
its released code.  The encoder starts at random: published weights cannot be had offline.
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
    # late: torch is slow to import
    from industnerf.methods.occupancy.run import fit

    return fit(examples, settings, seed, scratch)


def reconstruct(
    inputs: MethodInputs, settings: OccupancySettings, state: ModelState, seed: int
) -> Reconstruction:
    """One prediction from each of `settings.eval_views` views: points of its surface."""
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
