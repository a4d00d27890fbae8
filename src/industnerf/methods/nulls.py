"""Null methods: all they know of a part is the size and place of its bounding box."""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float

from industnerf.geometry.shapes import ball_surface, box_surface
from industnerf.methods.base import Given, Input, Method, Reconstruction, Role, Scope
from industnerf.schema import SampleSettings


def reconstruct_ball(
    given: Given, settings: SampleSettings, state: None, seed: int
) -> Reconstruction:
    """The sphere about the box's centre whose diameter is the mean of the box's extents."""
    return _in_the_box(ball_surface, given, settings, seed)


def reconstruct_box(
    given: Given, settings: SampleSettings, state: None, seed: int
) -> Reconstruction:
    """The surface of the box."""
    return _in_the_box(box_surface, given, settings, seed)


def _in_the_box(
    surface: Callable[..., Float[np.ndarray, "n 3"]],
    given: Given,
    settings: SampleSettings,
    seed: int,
) -> Reconstruction:
    corners = given.own_mesh.vertices
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
        random=True,
    )
    for name, reconstruct in (("ball", reconstruct_ball), ("box", reconstruct_box))
}
