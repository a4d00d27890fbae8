"""Methods that sample a surface they are given.

`ball` and `box` know the part's bounding box alone: any method must beat them.  `oracle` samples
the true surface that can be seen: but for chance no method can beat it there.
"""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float

from industnerf.geometry.raycast import RaycastingScene
from industnerf.geometry.sampling import ball_surface, box_surface, sample_surface
from industnerf.geometry.sphere import fibonacci_sphere
from industnerf.geometry.visibility import RELATIVE_TOLERANCE, visible_from
from industnerf.methods.base import Input, Method, MethodInputs, Reconstruction, Role, Scope
from industnerf.schema import SampleSettings

NUM_CAMERAS, CAMERA_DISTANCE = 40, 4.1  # on a sphere about the part, in radii of its bounding ball


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
    """Area-uniform points of the part's own mesh, as far as cameras all round see it.

    Hidden walls of an assembly lie so near behind visible ones that the protocol would count
    points of them, to which no visible surface corresponds.
    """
    mesh, rng = inputs.own_mesh, np.random.default_rng(seed)
    points, _ = sample_surface(mesh.vertices, mesh.faces, settings.points, rng)
    center = (mesh.vertices.min(axis=0) + mesh.vertices.max(axis=0)) / 2
    radius = np.linalg.norm(mesh.vertices - center, axis=1).max()
    cameras = center + CAMERA_DISTANCE * radius * fibonacci_sphere(NUM_CAMERAS)
    tolerance = RELATIVE_TOLERANCE * float(np.linalg.norm(np.ptp(mesh.vertices, axis=0)))
    scene = RaycastingScene(mesh.vertices, mesh.faces)
    return Reconstruction(points[visible_from(scene, points, cameras, tolerance)])


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
