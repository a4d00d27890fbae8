"""AtlasNet: a surface as patches that a network deforms, from one photograph.

Groueix et al., "A Papier-Mache Approach to Learning 3D Surface Generation" (2018), as the authors'
second code has it.  It sees one view at a time, so that several views give several predictions.
What differs: parts fill the unit cube, not the unit ball; no mirror images; patches start on a
sphere, the decoder has no batch norm, the Chamfer distance is not squared, one training of all
weights takes the place of three, and the network is told the axes of the picture.  `network` and
`chamfer` have the reasons.
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
from industnerf.schema import AtlasNetSettings


def fit(
    examples: Sequence[Example],
    settings: AtlasNetSettings,
    seed: int,
    scratch: Path,
    prior: Prior = NO_PRIOR,
) -> ModelState:
    """Weights of the image encoder and the decoder, after training."""
    # late: torch is slow to import
    from industnerf.methods.atlasnet.run import fit

    return fit(examples, settings, seed, scratch, prior)


def reconstruct(
    inputs: MethodInputs, settings: AtlasNetSettings, state: ModelState, seed: int
) -> Reconstruction:
    """One prediction from each of `settings.eval_views` views."""
    from industnerf.methods.atlasnet.run import reconstruct

    return reconstruct(inputs, settings, state, seed)


METHODS = {
    "atlasnet": Method(
        "atlasnet",
        Scope.DATASET,
        NETWORK_INPUTS,
        reconstruct,
        fit,
        is_stochastic=True,
    )
}
