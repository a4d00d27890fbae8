"""Rolling bearings and bearing units."""

from bd_warehouse.bearing import SingleRowAngularContactBallBearing
from build123d import Axis, Rot, Shape, fillet

from industnerf.parts.families.drawing import (
    bar,
    on_grid,
    rod,
    rods,
    rounded_block,
    turned,
)
from industnerf.parts.recipe import Recipe


def angular_contact(size: str) -> Shape:
    """Boundary dimensions of ISO 15; races, balls and cage as bd_warehouse draws them."""
    return SingleRowAngularContactBallBearing(size)


def square_flange_unit(
    bore: float, side: float, bolt_pitch: float, bolt_hole: float, insert: float
) -> Shape:
    """Insert bearing in a square cast housing, after ISO 3228 (UCF) and ISO 9628 (UC)."""
    flange, neck = 15.0, 27.0  # heights of the plate and of the housing round the insert
    inner_ring, inner_length, inner_base = 1.36 * bore, 34.1, 1.7
    shield = 1.2  # the seal lies this deep behind the faces of the outer ring
    outer_length, outer_base = 15.0, 10.0

    housing = rounded_block(side, side, flange, 0.16 * side)
    housing = fillet(housing.faces().sort_by(Axis.Z)[-1].edges(), 2.0)
    housing += turned(
        [(0, 0), (0.74 * insert, 0), (0.74 * insert, flange), (0.66 * insert, neck), (0, neck)]
    )
    housing -= rods(on_grid(bolt_pitch, bolt_pitch), bolt_hole, neck)
    housing -= rod(insert, neck)

    outer = rod(insert, outer_length, (0, 0, outer_base)) - rod(0.87 * insert, neck)
    seal = rod(0.9 * insert, outer_length - 2 * shield, (0, 0, outer_base + shield))
    inner = rod(inner_ring, inner_length, (0, 0, inner_base))
    collar_screw = bar(5.0, inner_ring, "x", (inner_ring / 2, 0, inner_base + inner_length - 4.5))
    unit = housing + outer + seal + inner - rod(bore, 2 * neck)
    return unit - collar_screw - Rot(0, 0, 120) * collar_screw


RECIPES = [
    Recipe(
        "bearing-angular-7304",
        "ISO 15 7304 20x52x15",
        "bd_warehouse",
        angular_contact,
        {"size": "M20-52-15"},
    ),
    Recipe(
        "bearing-flange-ucf205",
        "ISO 3228 UCF205-like",
        "build123d",
        square_flange_unit,
        {"bore": 25.0, "side": 95.0, "bolt_pitch": 70.0, "bolt_hole": 11.5, "insert": 52.0},
    ),
]
