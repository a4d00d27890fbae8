"""Grown without limbs: a seashell, a supershape, a pebble and a knot."""

import numpy as np
from jaxtyping import Float
from manifold3d import Manifold

from industnerf.artifacts.part import Mesh
from industnerf.parts.catalogue.organic.face_colors import assemble, color_faces
from industnerf.parts.catalogue.organic.forms import Points, plane_wave_noise, tube, union

GROWTH = 0.075  # of the seashell: exp(2 pi b) = 1.6 a whorl


def seashell(edge_mm: float, height: float, whorls: int, ribs: int) -> Mesh:
    """A ribbed tube whose radius, distance and height grow by exp(b t): Raup's spiral (1966).

    Half-whorls are tubes of their own, for a tube must not meet itself.  A thinner spiral hollows
    out the last whorl, and is the second finish.
    """
    joints = np.pi * np.arange(-2 * whorls, 1)
    spans = zip(joints[:-1], joints[1:] + 0.1, strict=True)
    outer = [_whorl(a, b, 1.0, ribs, height, edge_mm) for a, b in spans]
    mouth = _whorl(-1.2 * np.pi, 0.9, 0.86, 0, height, edge_mm)
    return assemble([union(outer)], carved=[mouth])


def _whorl(
    start: float, stop: float, share: float, ribs: int, height: float, edge_mm: float
) -> Manifold:
    t = np.linspace(start, stop, max(16, round(1.1 * height * np.exp(GROWTH * stop) / edge_mm)))
    scale = height * np.exp(GROWTH * t)
    unit = np.stack([-0.25 * np.cos(t), -0.25 * np.sin(t), np.full(len(t), -0.92)], axis=1)
    radii = share * 0.25 * scale * (1 + 0.035 * np.sin(ribs * t))
    return tube(unit * scale[:, None], radii, edge_mm)


def supershape(edge_mm: float, diameter: float, lobes: int) -> Mesh:
    """Gielis' superformula around, times a rounder one upright (2003); crests of another color."""

    def crest(points: Points) -> Float[np.ndarray, "n"]:
        angle = np.arctan2(points[:, 1], points[:, 0])
        return 0.35 - np.cos(lobes * angle)

    def supershape(points: Points) -> Points:
        x, y, z = points.T
        around = superformula(np.arctan2(y, x), lobes, 2.4, 4.0)
        upright = superformula(np.arctan2(z, np.hypot(x, y)), 4, 7.0, 4.0)
        return points * upright[:, None] * np.stack([around, around, np.ones_like(z)], axis=1)

    ball = Manifold.sphere(diameter / 3.4, round(np.pi * diameter / edge_mm))
    mesh = assemble([ball.warp_batch(lambda points: supershape(np.array(points)))])
    return color_faces(mesh, [crest], lambda p: np.where(crest(p) < 0, 1, 0))


def superformula(
    angle: Float[np.ndarray, "n"], lobes: int, n1: float, n2: float
) -> Float[np.ndarray, "n"]:
    """r = (|cos(m a / 4)|^n2 + |sin(m a / 4)|^n2)^(-1 / n1)."""
    quarter = lobes * angle / 4
    return (np.abs(np.cos(quarter)) ** n2 + np.abs(np.sin(quarter)) ** n2) ** (-1 / n1)


def pebble(edge_mm: float, length: float, seed: int) -> Mesh:
    """A flattened ball moved in and out by noise; veins where a second noise is near zero."""

    def worn(points: Points) -> Points:
        bump = 1 + 0.055 * plane_wave_noise(points, seed, 0.9 * length, 3)
        return points * bump[:, None] * [1.0, 0.75, 0.55]

    def vein(points: Points) -> Float[np.ndarray, "n"]:
        return plane_wave_noise(points, seed + 1, 0.8 * length, 2)

    ball = Manifold.sphere(length / 2, round(np.pi * length / edge_mm))
    mesh = assemble([ball.warp_batch(lambda points: worn(np.array(points)))])
    sides = [lambda p: vein(p) - 0.1, lambda p: vein(p) + 0.1, lambda p: vein(p) - 1.1]
    return color_faces(mesh, sides, lambda p: np.digitize(vein(p), [-0.1, 0.1, 1.1]) % 3)


def knot(edge_mm: float, diameter: float, p: int, q: int) -> Mesh:
    """A tube along the (p, q) torus knot."""
    t = np.linspace(0, 2 * np.pi, round(2.2 * p * diameter / edge_mm), endpoint=False)
    out = 2 + np.cos(q * t)
    centers = np.stack([out * np.cos(p * t), out * np.sin(p * t), 1.15 * np.sin(q * t)], axis=1)
    unit = diameter / 7.24
    return assemble([tube(unit * centers, np.full(len(t), 0.62 * unit), edge_mm, closed=True)])
