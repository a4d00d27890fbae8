"""Joints between shafts that meet at an angle."""

from build123d import Plane, Pos, Rot, Shape, extrude

from industnerf.parts.catalogue.families.drawing import (
    Real,
    bar,
    block,
    chamfered_rod,
    fused,
    rod,
    tangent_hull,
)
from industnerf.parts.catalogue.recipe import Assembly, Recipe


def yoke(diameter: Real, bore: Real, pivot: Real) -> Shape:
    """Fork of a universal joint, its mouth up; the pin is to run along x at z = `pivot`."""
    slot, foot = 0.56 * diameter, 0.58 * pivot
    side = tangent_hull((0, 0.3 * pivot), 0.48 * diameter, (0, pivot), 0.25 * diameter)
    fork = extrude(Plane.YZ * side, diameter, both=True) & rod(diameter, 2 * pivot)
    fork += chamfered_rod(diameter, 0.45 * pivot, 1.0)
    fork -= block(slot, 2 * diameter, 2 * pivot, (0, 0, foot))
    return fork - rod(bore, pivot)


def universal_joint(diameter: Real, bore: Real, pivot: Real, angle: Real) -> Assembly:
    """Single joint after DIN 808, bent by `angle` degrees about the lower fork's pin."""
    pin, center = 0.27 * diameter, Pos(0, 0, pivot)
    fork = yoke(diameter, bore, pivot)
    bend = center * Rot(angle, 0, 0)
    other = bend * Rot(180, 0, 90) * Pos(0, 0, -pivot) * fork
    cube = 0.5 * diameter
    cross = bend * block(cube, cube, cube, (0, 0, -cube / 2))
    pins = [bend * bar(pin, 1.01 * diameter, axis) for axis in "xy"]
    return Assembly(
        {"steel": fused([fork, other]), "black oxide": cross, "bright steel": fused(pins)}
    )


RECIPES = [
    Recipe(
        "joint-universal-d36",
        "DIN 808-like universal joint D36, bore 20, bent by 20 deg",
        "build123d",
        universal_joint,
        {"diameter": 36.0, "bore": 20.0, "pivot": 43.0, "angle": 20.0},
    )
]
