"""Methods that sample a surface they are given.

`ball` and `box` know the part's bounding box alone: any method must beat them.  `oracle` samples
the true surface: no method can beat it.
"""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float

from industnerf.geometry.sampling import ball_surface, box_surface, sample_surface
from industnerf.methods.base import Input, Method, MethodInputs, Reconstruction, Role, Scope
from industnerf.schema import SampleSettings


def reconstruct_ball(
    inputs: MethodInputs, settings: SampleSettings, state: None, seed: int
) -> Reconstruction:
    """The sphere about the box's center whose diameter is the mean of the box's extents."""
    return _sample_in_box(ball_surface, inputs, settings, seed)


def reconstruct_box(
    inputs: MethodInputs, settings: SampleSettings, state: None, seed: int
) -> Reconstruction:
    """The surface of the box."""
    return _sample_in_box(box_surface, inputs, settings, seed)


def _sample_in_box(
    surface: Callable[..., Float[np.ndarray, "n 3"]],
    inputs: MethodInputs,
    settings: SampleSettings,
    seed: int,
) -> Reconstruction:
    corners = inputs.own_mesh.vertices
    low, high = corners.min(axis=0), corners.max(axis=0)
    rng = np.random.default_rng(seed)
    return Reconstruction(surface(high - low, (low + high) / 2, settings.points, rng))


def reconstruct_oracle(
    inputs: MethodInputs, settings: SampleSettings, state: None, seed: int
) -> Reconstruction:
    """Area-uniform points of the part's own mesh, hidden surface included."""
    mesh, rng = inputs.own_mesh, np.random.default_rng(seed)
    points, _ = sample_surface(mesh.vertices, mesh.faces, settings.points, rng)
    return Reconstruction(points)


METHODS = {
    name: Method(
        name,
        Scope.PART,
        frozenset({Input.OWN_MESH}),
        reconstruct,
        role=role,
        is_stochastic=True,
    )
    for name, reconstruct, role in (
        ("ball", reconstruct_ball, Role.NULL),
        ("box", reconstruct_box, Role.NULL),
        ("oracle", reconstruct_oracle, Role.BOUND),
    )
}
