"""Thin all through: a wire basket and a gyroid in a ball."""

import numpy as np
from jaxtyping import Float
from manifold3d import Manifold

from industnerf.artifacts.part import Mesh
from industnerf.parts.catalogue.organic.face_colors import assemble
from industnerf.parts.catalogue.organic.forms import Points, curve, level_set, tube, union

PROFILE = np.array(  # of the basket: radius and z, as shares of the diameter
    [(0.04, 0.0), (0.16, 0.0), (0.29, 0.01), (0.36, 0.07), (0.41, 0.19), (0.45, 0.32), (0.5, 0.44)]
)


def basket(edge_mm: float, diameter: float, wire: float, staves: int, hoops: int) -> Mesh:
    """Upright staves woven by hoops that pass before one and behind the next; rim and handle.

    `staves` is even, so that a hoop closes.
    """
    upright = curve(PROFILE, 0.028) * diameter
    turns = 2 * np.pi * np.arange(staves) / staves
    bars = [_tube(_turned(upright, turn), wire, edge_mm) for turn in turns]
    heights = np.linspace(0.05, 1.0, hoops) ** 0.8 * (len(upright) - 1)
    along = np.arange(len(upright))
    hoop_positions = np.stack([np.interp(heights, along, upright[:, k]) for k in (0, 1)], axis=1)
    woven = [
        _hoop(radius_z, i % 2, wire, staves, edge_mm) for i, radius_z in enumerate(hoop_positions)
    ]
    rim, foot = (
        _hoop(radius_z, 0, 2.2 * wire, 0, edge_mm) for radius_z in (upright[-1], upright[0])
    )
    arc = np.pi * np.linspace(0, 1, 40)[:, None]
    over = upright[-1, 0] * np.concatenate([np.cos(arc), 0 * arc, 1.05 * np.sin(arc)], axis=1)
    handle = _tube(over + np.array([0, 0, upright[-1, 1]]), 2.2 * wire, edge_mm)
    return assemble([union([*bars, *woven, foot]), union([rim, handle])])


def _tube(centerline: Points, wire: float, edge_mm: float) -> Manifold:
    return tube(centerline, np.full(len(centerline), wire / 2), edge_mm)


def _turned(profile: Float[np.ndarray, "n 2"], turn: float) -> Points:
    out, up = profile.T
    return np.stack([out * np.cos(turn), out * np.sin(turn), up], axis=1)


def _hoop(
    radius_z: Float[np.ndarray, "2"], phase: int, wire: float, waves: int, edge_mm: float
) -> Manifold:
    """A closed wire at (radius, z) that swings half its thickness in and out."""
    num_points = max(8 * waves, round(2 * np.pi * float(radius_z[0]) / edge_mm), 16)
    turn = 2 * np.pi * np.arange(num_points) / num_points
    out = radius_z[0] + 0.6 * wire * np.cos(waves / 2 * turn + np.pi * phase) * (waves > 0)
    centerline = np.stack(
        [out * np.cos(turn), out * np.sin(turn), np.full(num_points, radius_z[1])], axis=1
    )
    return tube(centerline, np.full(num_points, wire / 2), edge_mm, closed=True)


def gyroid(edge_mm: float, diameter: float, cell: float, thickness: float) -> Mesh:
    """The wall |g| <= thickness / 2 |grad g| about sin x cos y + sin y cos z + sin z cos x = 0,
    within a ball."""
    k = 2 * np.pi / cell

    def wall(points: Points) -> Float[np.ndarray, "n"]:
        sine, cosine = np.sin(k * points), np.cos(k * points)
        value = (sine * np.roll(cosine, -1, axis=1)).sum(axis=1)
        slope = cosine * np.roll(cosine, -1, axis=1) - np.roll(sine, 1, axis=1) * sine
        return thickness / 2 - np.abs(value) / (k * np.linalg.norm(slope, axis=1) + 1e-9)

    reach = [diameter / 2 + 2 * edge_mm] * 3
    filling = level_set(wall, [-x for x in reach], reach, edge_mm)
    ball = Manifold.sphere(diameter / 2, round(np.pi * diameter / edge_mm))
    return assemble([(filling ^ ball).simplify(0.015)])
