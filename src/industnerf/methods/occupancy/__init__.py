"""Occupancy Networks: whether a point is inside the part, given one photograph of it.

Mescheder et al., "Occupancy Networks: Learning 3D Reconstruction in Function Space" (2019), with
its released code.  What differs: the decoder knows a point both in the part's axes and in those of
the picture, whose camera is known; and the surface is where it encloses the volume that the
probabilities sum up to, for at a fixed threshold thin parts vanish.
"""

from collections.abc import Sequence
from pathlib import Path

from industnerf.artifacts.state import ModelState
from industnerf.learning.training_shape import NO_PRIOR, Prior
from industnerf.methods.base import (
    NETWORK_INPUTS,
    Example,
    Method,
    MethodInputs,
    Reconstruction,
    Scope,
)
from industnerf.schema import OccupancySettings


def fit(
    examples: Sequence[Example],
    settings: OccupancySettings,
    seed: int,
    scratch: Path,
    prior: Prior = NO_PRIOR,
) -> ModelState:
    """The weights of one training, and how it went."""
    # late: torch is slow to import
    from industnerf.methods.occupancy.run import fit

    return fit(examples, settings, seed, scratch, prior)


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
        NETWORK_INPUTS,
        reconstruct,
        fit,
        is_stochastic=True,
    )
}
