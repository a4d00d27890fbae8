"""The part's true surface, sampled anew: the bound of the metric itself."""

import numpy as np

from industnerf.geometry.sampling import sample_surface
from industnerf.methods.base import Input, Method, MethodInputs, Reconstruction, Role, Scope
from industnerf.schema import SampleSettings


def reconstruct(
    inputs: MethodInputs, settings: SampleSettings, state: None, seed: int
) -> Reconstruction:
    """Area-uniform points of the part's own mesh, hidden surface included."""
    mesh, rng = inputs.own_mesh, np.random.default_rng(seed)
    points, _ = sample_surface(mesh.vertices, mesh.faces, settings.points, rng)
    return Reconstruction(points)


METHODS = {
    "oracle": Method(
        "oracle",
        Scope.PART,
        frozenset({Input.OWN_MESH}),
        reconstruct,
        role=Role.BOUND,
        is_stochastic=True,
    )
}
