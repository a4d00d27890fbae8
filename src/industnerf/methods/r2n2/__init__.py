"""3D-R2N2 -- Choy et al. (2016): from one or several images to the voxels of a part.

The residual network, which is the paper's best: every image becomes a vector, a recurrent unit on a
grid of 4^3 cells takes the vectors one after another, and a decoder makes 32^3 voxels of its hidden
state.  It learns from other parts and is given no camera poses.
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
from industnerf.schema import R2n2Settings


def fit(
    examples: Sequence[Example],
    settings: R2n2Settings,
    seed: int,
    scratch: Path,
    prior: Prior = NO_PRIOR,
) -> ModelState:
    """The weights of a network trained on `examples`."""
    from industnerf.methods.r2n2.train import fit_net

    return fit_net(examples, settings, seed, scratch, prior)


def reconstruct(
    inputs: MethodInputs, settings: R2n2Settings, state: ModelState, seed: int
) -> Reconstruction:
    """Points of the surface that the network predicts from `max_views` images, in one pass."""
    from industnerf.methods.r2n2.predict import predict_part

    return predict_part(inputs, settings, state, seed)


METHODS = {
    "r2n2": Method(
        "r2n2",
        Scope.DATASET,
        NETWORK_INPUTS,
        reconstruct,
        fit,
        is_stochastic=True,
    )
}
