"""3D-R2N2 -- Choy et al. (2016): from one or several pictures to the voxels of a part.

The residual net, which is the paper's best: every picture becomes a vector, a recurrent unit on a
grid of 4^3 cells remembers what the pictures say one after another, and a decoder makes 32^3
voxels of its memory.  It learns from other parts and is not told where the cameras are.
"""

from collections.abc import Sequence
from pathlib import Path

from industnerf.artifacts.state import State
from industnerf.methods.base import Example, Given, Input, Method, Reconstruction, Scope
from industnerf.schema import R2n2Settings


def fit(examples: Sequence[Example], settings: R2n2Settings, seed: int, scratch: Path) -> State:
    """The weights of a net that was trained on `examples`."""
    from industnerf.methods.r2n2.teach import trained

    return trained(examples, settings, seed, scratch)


def reconstruct(given: Given, settings: R2n2Settings, state: State, seed: int) -> Reconstruction:
    """Points of the surface of what the net makes of `views` pictures, in one pass.

    Raises ReconstructionFailed if no voxel is likely enough to be full.
    """
    from industnerf.methods.r2n2.predict import predicted

    return predicted(given, settings, state, seed)


METHODS = {
    "r2n2": Method(
        "r2n2",
        Scope.DATASET,
        frozenset({Input.RGB, Input.FRAME, Input.OTHER_MESHES}),
        reconstruct,
        fit,
        random=True,
    )
}
