"""Couplings between two shafts along z."""

from build123d import Pos, Rot, extrude

from industnerf.parts.catalogue.families.drawing import (
    Real,
    bar,
    block,
    chamfered_rod,
    copies_on_circle,
    fused,
    hexagon,
    keyed_bore,
    on_circle,
    polygon,
    rod,
    rods,
    tube,
    turned,
)
from industnerf.parts.catalogue.recipe import Assembly, Recipe


def flange_coupling(
    flange: Real, hub: Real, length: Real, bore: Real, key: Real, bolt: Real, bolts: int
) -> Assembly:
    """Rigid coupling after DIN 116: two cast halves, joined in the plane z = 0 by hexagon bolts."""
    plate, edge, recess = 0.16 * flange, 1.5, 0.03 * flange
    rim = flange / 2 - 0.06 * flange
    half = turned(
        [
            (0, 0),
            (flange / 2 - 0.5, 0),
            (flange / 2, 0.5),
            (flange / 2, plate + recess - edge),
            (flange / 2 - edge, plate + recess),
            (rim, plate + recess),
            (rim - 1, plate),
            (hub / 2 + 4, plate),
            (hub / 2, plate + 4),
            (hub / 2, length - edge),
            (hub / 2 - edge, length),
            (0, length),
        ]
    )
    points = on_circle(bolts, (hub / 2 + 4 + rim))
    halves = half + Rot(180, 0, 0) * half - keyed_bore(bore, key, 2 * length, -length)
    head, nut = 0.64 * bolt, 0.8 * bolt
    hexagons = [hexagon(1.6 * bolt, head, (x, y, plate)) for x, y in points]
    hexagons += [hexagon(1.6 * bolt, nut, (x, y, -plate - nut)) for x, y in points]
    shanks = rods(points, bolt, 2 * plate + 1.5 * nut, -plate - 1.4 * nut)
    return Assembly({"cast iron": halves, "zinc": fused([*hexagons, *shanks])})


def jaw_coupling(diameter: Real, hub: Real, bore: Real, key: Real) -> Assembly:
    """One hub of an elastic jaw coupling, its three claws up, with the star of six pads in them."""
    claw, eye, pad = 0.34 * diameter, 0.46 * diameter, 0.16 * diameter
    reach = 2 * diameter
    sector = extrude(polygon([(0, 0), (reach, -0.577 * reach), (reach, 0.577 * reach)]), claw)
    gaps = copies_on_circle(6, block(diameter, pad, claw, (diameter / 2, 0, 0)), 30)
    claws = copies_on_circle(3, Pos(0, 0, hub - 1) * ((sector & tube(diameter, eye, claw)) - gaps))
    screw = bar(0.1 * diameter, diameter, "x", (-diameter / 2, 0, 0.4 * hub))
    base = 1.0  # the star keeps clear of the hub
    arm = block(0.48 * diameter, pad + 0.2, claw - 2 * base, (0.24 * diameter, 0, 0))
    star = [
        Pos(0, 0, hub + base) * a for a in copies_on_circle(6, arm & rod(0.95 * diameter, claw), 30)
    ]
    ring = rod(eye - 1, claw - 2 * base, (0, 0, hub + base))
    cut = [*keyed_bore(bore, key, 2 * hub, -hub / 2), screw]
    body = chamfered_rod(diameter, hub, 1.0)
    return Assembly(
        {
            "aluminum": fused([body, *claws]) - cut,
            "red paint": fused([ring, *star]) - rod(bore, 4 * hub),
        }
    )


def oldham_coupling(diameter: Real, hub: Real, disc: Real, bore: Real) -> Assembly:
    """Two hubs whose tongues, at right angles, slide in the grooves of a plastic disc."""
    tongue, depth, gap = 0.22 * diameter, 0.34 * disc, 0.4
    tight = 0.1  # what the groove is narrower, so that the two bodies overlap
    groove = block(tongue - tight, 2 * diameter, disc, (0, 0, disc / 2 - depth))
    top = chamfered_rod(diameter, hub, 0.8, (0, 0, disc / 2 + gap))
    tenon = block(tongue, diameter, depth + 2, (0, 0, disc / 2 - depth - tight))
    top += tenon & rod(diameter, disc)
    screw = bar(0.1 * diameter, diameter, "x", (diameter / 2, 0, disc / 2 + 0.6 * hub))
    plug = bar(0.105 * diameter, 0.3 * diameter, "x", (0.33 * diameter, 0, disc / 2 + 0.6 * hub))
    drill = rod(bore, 4 * hub, (0, 0, -2 * hub))
    over = Rot(180, 0, 90)
    slab = rod(diameter, disc, (0, 0, -disc / 2)) - rod(1.2 * bore, 2 * disc, (0, 0, -disc))
    return Assembly(
        {
            "aluminum": fused([top, over * top]) - [drill, screw, over * screw],
            "black plastic": slab - [groove, over * groove],
            "black oxide": fused([plug, over * plug]) - drill,
        }
    )


RECIPES = [
    Recipe(
        "coupling-flange-d120",
        "DIN 116-like rigid flange coupling D120, bore 30",
        "build123d",
        flange_coupling,
        {
            "flange": 120.0,
            "hub": 58.0,
            "length": 55.0,
            "bore": 30.0,
            "key": 8.0,
            "bolt": 10.0,
            "bolts": 6,
        },
    ),
    Recipe(
        "coupling-jaw-d55",
        "jaw coupling hub D55 with its star, bore 20",
        "build123d",
        jaw_coupling,
        {"diameter": 55.0, "hub": 30.0, "bore": 20.0, "key": 6.0},
    ),
    Recipe(
        "coupling-oldham-d40",
        "Oldham coupling D40, bore 12",
        "build123d",
        oldham_coupling,
        {"diameter": 40.0, "hub": 16.0, "disc": 12.0, "bore": 12.0},
    ),
]
