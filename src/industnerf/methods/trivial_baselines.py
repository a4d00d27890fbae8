"""Null methods: all they know of a part is the size and place of its bounding box."""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float

from industnerf.geometry.shapes import ball_surface, box_surface
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


METHODS = {
    name: Method(
        name,
        Scope.PART,
        frozenset({Input.OWN_MESH}),
        reconstruct,
        role=Role.NULL,
        is_stochastic=True,
    )
    for name, reconstruct in (("ball", reconstruct_ball), ("box", reconstruct_box))
}
