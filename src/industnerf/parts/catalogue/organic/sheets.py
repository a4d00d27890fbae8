"""Thin sheets with a real thickness: a leaf, a scroll and an umbrella."""

import numpy as np
from jaxtyping import Float
from manifold3d import Manifold

from industnerf.artifacts.part import Mesh
from industnerf.parts.catalogue.organic.face_colors import assemble, color_faces
from industnerf.parts.catalogue.organic.forms import Points, curve, sheet, tube, union


def leaf(edge_mm: float, length: float, thickness: float, veins: int) -> Mesh:
    """A blade of half-width 0.27 L sin(pi s^0.8)^0.9, bent, folded and wavy, on a stalk."""
    n, m = round(length / edge_mm), 2 * round(0.27 * length / edge_mm) + 1
    s, t = np.meshgrid(np.linspace(0.003, 0.975, n), np.linspace(-1, 1, m), indexing="ij")
    half = _half_width(s, length)
    rise = 0.13 * length * np.sin(2.9 * s) + 0.3 * half * np.abs(t) ** 1.5
    wave = 0.08 * half * np.sin(2 * np.pi * 4 * s + np.sign(t)) * t**4
    middle = np.stack([length * (s - 0.5), half * t, rise + wave], axis=-1)
    blade = sheet(middle, thickness)

    def vein(points: Points) -> Float[np.ndarray, "n"]:
        s = np.clip(points[:, 0] / length + 0.5, 0, 1)
        side = np.abs(points[:, 1]) / _half_width(s, length)
        rank = veins * (s - 0.22 * side)
        return np.maximum(np.cos(2 * np.pi * rank) - 0.955 + 0.03 * side, 0.035 - side)

    mesh = assemble([blade, _stalk(middle[:, m // 2], length, thickness, edge_mm)])
    return color_faces(mesh, [vein], lambda p: np.where(vein(p) > 0, 1, 0))


def _half_width(s: Float[np.ndarray, "*any"], length: float) -> Float[np.ndarray, "*any"]:
    return 0.27 * length * np.sin(np.pi * s**0.8) ** 0.9 + 0.5


def _stalk(rib: Points, length: float, thickness: float, edge_mm: float) -> Manifold:
    """From below the blade along its underside, thinner and thinner."""
    under = rib[: int(0.9 * len(rib)) : len(rib) // 8] - [0, 0, 0.5 * thickness]
    foot = under[0] + length * np.array([[-0.28, 0.03, -0.10], [-0.14, 0.01, -0.065]])
    centerline = curve(np.concatenate([foot, under]), 2 * edge_mm)
    return tube(centerline, thickness * np.linspace(1.2, 0.6, len(centerline)), edge_mm)


def scroll(edge_mm: float, width: float, thickness: float, turns: int) -> Mesh:
    """Written paper, rolled up at one end: r = 7 mm + 3.5 thickness * turns, then nearly flat."""
    pitch = 3.5 * thickness / (2 * np.pi)
    angle = np.linspace(0, 2 * np.pi * turns, round(70 * turns / edge_mm))
    radius = 7.0 + pitch * angle
    rolled = np.stack([radius * np.sin(angle), -radius * np.cos(angle)], axis=1)

    def flat(x: Float[np.ndarray, "*any"]) -> Float[np.ndarray, "*any"]:
        return -radius[-1] - pitch / radius[-1] * x + 0.2 / width * x**2

    tail = np.linspace(0, width, round(width / edge_mm))[1:]
    x, z = np.concatenate([rolled, np.stack([tail, flat(tail)], axis=1)]).T
    y = np.linspace(-0.4 * width, 0.4 * width, round(0.8 * width / edge_mm))
    grid = np.meshgrid(x, y, indexing="ij")
    middle = np.stack([*grid, np.broadcast_to(z[:, None], grid[0].shape)], axis=-1)

    def ink(points: Points) -> Float[np.ndarray, "n"]:
        x, y, z = points.T
        line_mask = np.cos(2 * np.pi * x / (0.09 * width)) - 0.3
        word_mask = 1.2 + np.sin(0.37 * y + x // (0.09 * width)) + np.sin(0.23 * y)
        margins = np.minimum(np.minimum(x - 0.27 * width, 0.92 * width - x), 0.33 * width - abs(y))
        return np.minimum(np.minimum(line_mask, word_mask), np.minimum(margins, z - flat(x)))

    mesh = assemble([sheet(middle, thickness)])
    return color_faces(mesh, [ink], lambda p: np.where(ink(p) > 0, 1, 0))


def umbrella(edge_mm: float, diameter: float, ribs: int, thickness: float) -> Mesh:
    """A canopy pulled in between its ribs, panels in two colors, on a stick with a crook."""
    per_panel = round(np.pi * diameter / ribs / edge_mm)
    angle = 2 * np.pi * np.arange(ribs * per_panel) / (ribs * per_panel)
    s = np.linspace(0.015, 1, round(0.58 * diameter / edge_mm))
    canopy = sheet(_canopy(s, angle, diameter, ribs), thickness, is_ring=True)
    spokes = _canopy(np.linspace(0.03, 1.015, 24), angle[::per_panel], diameter, ribs)
    radii = np.full(len(spokes), 0.8 * thickness)
    wires = [tube(spokes[:, k] - [0, 0, thickness], radii, edge_mm) for k in range(ribs)]

    def panel(points: Points) -> Float[np.ndarray, "n"]:
        return np.sin(ribs / 2 * np.arctan2(points[:, 1], points[:, 0]))

    mesh = assemble([canopy, union(wires), _stick(diameter, edge_mm)])
    return color_faces(mesh, [panel], lambda p: np.where(panel(p) > 0, 3, 0))


def _canopy(
    s: Float[np.ndarray, "n"], angle: Float[np.ndarray, "m"], diameter: float, ribs: int
) -> Float[np.ndarray, "n m 3"]:
    """Part of a ball: x = sin(1.35 s), z = cos(1.35 s), less up to 13 % of x between the ribs."""
    s = s[:, None]
    pulled = 1 - 0.13 * s**2 * np.abs(np.sin(ribs * angle / 2))
    out = diameter / 2 * np.sin(1.35 * s) / np.sin(1.35) * pulled
    up = np.broadcast_to(0.42 * diameter * (np.cos(1.35 * s) - 1), out.shape)
    return np.stack([out * np.cos(angle), out * np.sin(angle), up], axis=-1)


def _stick(diameter: float, edge_mm: float) -> Manifold:
    """From the ferrule on top down to the crook."""
    bend = np.linspace(0, 1.15 * np.pi, 12)
    crook = np.stack([1 - np.cos(bend), 0 * bend, -np.sin(bend)], axis=1) * 0.07 * diameter
    straight = np.linspace(0.1, -0.78, 14)[:, None] * diameter * [0, 0, 1]
    centerline = curve(np.concatenate([straight[:-1], crook + straight[-1]]), edge_mm)
    return tube(centerline, np.full(len(centerline), 0.014 * diameter), edge_mm)
