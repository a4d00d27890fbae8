"""Housed bearing units: insert bearings in cast housings."""

from build123d import Axis, Pos, Rot, Shape, fillet

from industnerf.parts.catalogue.families.drawing import (
    PRESS,
    Point,
    Real,
    bar,
    on_grid,
    rod,
    rods,
    rounded_block,
    slot,
    turned,
    upright,
)
from industnerf.parts.catalogue.recipe import Assembly, Recipe


def insert_bearing(bore: Real, outside: Real) -> dict[str, Shape]:
    """ISO 9628 UC by finish: a wide inner ring with two set screws, seals and an outer ring.

    About z, the middle of the outer ring at z = 0.
    """
    outer_length, inner_length, inner_base = 15.0, 34.1, -15.8
    inner_ring, shield = 1.36 * bore, 1.2  # the seals lie this deep behind the outer ring's faces
    outer = rod(outside + 2 * PRESS, outer_length, (0, 0, -outer_length / 2))
    outer -= rod(0.87 * outside, outer_length, (0, 0, -outer_length / 2))
    seal_length = outer_length - 2 * shield
    seals = rod(0.9 * outside, seal_length, (0, 0, -seal_length / 2))
    inner = rod(inner_ring, inner_length, (0, 0, inner_base))
    screw = bar(5.0, inner_ring, "x", (inner_ring / 2, 0, inner_base + inner_length - 4.5))
    inner -= [screw, Rot(0, 0, 120) * screw]
    hole, wider = (rod(d, 2 * inner_length, (0, 0, -inner_length)) for d in (bore, 1.2 * bore))
    return {"steel": outer, "rubber": seals - wider, "bright steel": inner - hole}


def grease_nipple() -> Shape:
    """DIN 71412, standing on z = 0."""
    tip = [(2.2, 4.0), (2.2, 6.5), (3.2, 8.0), (2.0, 10.0), (0, 10.0)]
    return turned([(0, -1.0), (3.8, -1.0), (3.8, 4.0), *tip])


def square_flange_unit(
    bore: float, side: float, bolt_pitch: float, bolt_hole: float, insert: float
) -> Assembly:
    """Insert bearing in a square cast housing, after ISO 3228 (UCF)."""
    flange, neck, middle = 15.0, 27.0, 17.5  # heights of the plate, the housing, the outer ring
    housing = rounded_block(side, side, flange, 0.16 * side)
    housing = fillet(housing.faces().sort_by(Axis.Z)[-1].edges(), 2.0)
    housing += turned(
        [(0, 0), (0.74 * insert, 0), (0.74 * insert, flange), (0.66 * insert, neck), (0, neck)]
    )
    housing -= rods(on_grid(bolt_pitch, bolt_pitch), bolt_hole, neck)
    housing -= rod(insert, neck)
    nipple = Rot(0, 0, 45) * Pos(0.69 * insert, 0, 0.8 * neck) * Rot(0, 60, 0) * grease_nipple()
    bearing = insert_bearing(bore, insert)
    seated = {finish: Pos(0, 0, middle) * body for finish, body in bearing.items()}
    return Assembly({"cast iron": housing, **seated, "brass": nipple})


def pillow_block_unit(
    bore: float, height: float, length: float, width: float, bolt_pitch: float, insert: float
) -> Assembly:
    """Insert bearing in a cast housing on two feet, after ISO 3228 (UCP).

    The shaft lies along y, `height` above the foot.
    """
    foot, boss, hole = 15.0, 24.0, 13.0
    shoulder = 0.66 * insert  # radius of the housing round the insert
    base = rounded_block(length, width, foot, 0.4 * width)
    base = fillet(base.faces().sort_by(Axis.Z)[-1].edges(), 2.0)
    body = bar(2 * shoulder, boss, "y", (0, 0, height))
    flank: list[Point] = [(0.28 * length, 0), (0.28 * length, foot), (shoulder, height)]
    outline = flank + [(-x, z) for x, z in reversed(flank)]
    body += upright(outline, boss)
    housing = base + body
    for x in (-bolt_pitch / 2, bolt_pitch / 2):
        housing -= slot(1.25 * hole, hole, foot, (x, 0, 0))
    housing -= bar(insert, 2 * width, "y", (0, 0, height))
    nipple = Pos(0, 0, height + shoulder) * grease_nipple()
    bearing = insert_bearing(bore, insert)
    seated = {f: Pos(0, 0, height) * Rot(-90, 0, 0) * body for f, body in bearing.items()}
    return Assembly({"green paint": housing, **seated, "brass": nipple})


RECIPES = [
    Recipe(
        "bearing-flange-ucf205",
        "ISO 3228 UCF205-like",
        "build123d",
        square_flange_unit,
        {"bore": 25.0, "side": 95.0, "bolt_pitch": 70.0, "bolt_hole": 11.5, "insert": 52.0},
    ),
    Recipe(
        "bearing-pillow-ucp205",
        "ISO 3228 UCP205-like",
        "build123d",
        pillow_block_unit,
        {
            "bore": 25.0,
            "height": 36.5,
            "length": 140.0,
            "width": 38.0,
            "bolt_pitch": 105.0,
            "insert": 52.0,
        },
    ),
]
