"""Turned and glazed: a vase with bands and zigzags, a teapot with dots."""

import numpy as np
from jaxtyping import Float
from manifold3d import Manifold

from industnerf.artifacts.part import Mesh
from industnerf.geometry.sphere import fibonacci_sphere
from industnerf.parts.catalogue.organic.face_colors import assemble, color_faces
from industnerf.parts.catalogue.organic.forms import Points, curve, revolve_profile, tube, union

VASE = np.array(  # radius and z of the outer wall, as shares of the height
    [
        *((0.17, 0.0), (0.20, 0.06), (0.28, 0.25), (0.31, 0.42), (0.26, 0.62), (0.15, 0.80)),
        *((0.12, 0.88), (0.14, 0.95), (0.18, 1.0)),  # neck and lip
    ]
)
POT = np.array(  # radius and z of the teapot's body and lid, as shares of the body's diameter
    [(0.26, 0.0), (0.36, 0.06), (0.48, 0.22), (0.50, 0.36), (0.42, 0.53), (0.28, 0.63)]
)
SPOUT = np.array([(0.40, 0.20), (0.57, 0.26), (0.67, 0.43), (0.79, 0.60)])  # x and z
HANDLE = np.array(
    [(-0.40, 0.53), (-0.58, 0.58), (-0.74, 0.50), (-0.74, 0.33), (-0.62, 0.20), (-0.44, 0.16)]
)
LID = np.array([(0.27, 0.64), (0.20, 0.69), (0.10, 0.725), (0.045, 0.74)])


def vase(edge_mm: float, height: float, wall: float, teeth: int) -> Mesh:
    """A hollow turned body; rings and two zigzags on its outside."""
    outer = curve(VASE, edge_mm / height) * height
    inner = (outer - [wall, 0])[outer[:, 1] > 2 * wall]
    bottom = [[0.0, 2 * wall], [0.0, 0.0]]
    mesh = assemble([revolve_profile(np.concatenate([outer, inner[::-1], bottom]), edge_mm)])

    def outside(points: Points) -> Float[np.ndarray, "n"]:
        out = np.hypot(points[:, 0], points[:, 1])
        return out - np.interp(points[:, 2], outer[:, 1], outer[:, 0]) + wall / 2

    def zigzag(points: Points, at: float) -> Float[np.ndarray, "n"]:
        turn = np.arctan2(points[:, 1], points[:, 0])
        tooth = 2 / np.pi * np.arcsin(np.sin(teeth * turn))
        return points[:, 2] / height - at - 0.035 * tooth

    levels = (0.04, 0.08, 0.16, 0.60, 0.68, 0.78, 0.83, 0.96)
    bands = [lambda p, at=at: p[:, 2] / height - at for at in levels]
    waves = [lambda p, at=at: zigzag(p, at) for at in (0.27, 0.36, 0.48)]

    def color(points: Points) -> np.ndarray:
        ring = np.array([1, 0, 1, 0, 2, 3, 0, 1, 0])[np.digitize(points[:, 2] / height, levels)]
        tooth = sum((wave(points) > 0).astype(int) for wave in waves)
        middle = (points[:, 2] > 0.16 * height) & (points[:, 2] < 0.60 * height)
        painted = np.where(middle, np.array([0, 2, 3, 0])[tooth], ring)
        return np.where(outside(points) > 0, painted, 0)

    return color_faces(mesh, [*bands, *waves], color)


def teapot(edge_mm: float, diameter: float, dots: int) -> Mesh:
    """A turned pot with lid, knob, spout and handle; dots on a spiral round the pot."""
    body, lid = (_filled(profile, diameter, edge_mm) for profile in (POT, LID))
    knob = Manifold.sphere(0.055 * diameter, round(0.35 * diameter / edge_mm) * 4)
    spout = _bent(SPOUT, (0.105, 0.047), diameter, edge_mm)
    bore = _bent(SPOUT[-2:] + np.array([0.02, 0.03]), (0.03, 0.034), diameter, edge_mm)
    handle = _bent(HANDLE, (0.042, 0.042), diameter, edge_mm)
    top = lid + knob.translate((0, 0, 0.775 * diameter))
    mesh = assemble([body, union([spout - bore, handle, top])])
    dot_centers = fibonacci_sphere(dots) * [1, 1, 0.9] * 0.5 * diameter + [0, 0, 0.33 * diameter]

    def dot(points: Points) -> Float[np.ndarray, "n"]:
        nearest = np.linalg.norm(points[:, None] - dot_centers, axis=2).min(axis=1)
        return 0.075 * diameter - nearest

    return color_faces(mesh, [dot], lambda p: np.where(dot(p) > 0, 2, 0))


def _filled(profile: Float[np.ndarray, "n 2"], diameter: float, edge_mm: float) -> Manifold:
    wall = curve(profile, edge_mm / diameter) * diameter
    axis = np.array([[0.0, wall[-1, 1]], [0.0, wall[0, 1] - 0.02 * diameter]])
    inset = wall[0] - [0.02 * diameter, 0.02 * diameter]
    return revolve_profile(np.concatenate([wall, axis, [inset]]), edge_mm)


def _bent(
    knots: Float[np.ndarray, "n 2"], radii: tuple[float, float], diameter: float, edge_mm: float
) -> Manifold:
    """A tube in the plane y = 0 from one radius to the other; all as shares of `diameter`."""
    centerline = curve(np.insert(knots, 1, 0.0, axis=1) * diameter, edge_mm)
    return tube(centerline, diameter * np.linspace(*radii, len(centerline)), edge_mm)
