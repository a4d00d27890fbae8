"""Elbows, caps and other pipe fittings."""

import math

from build123d import (
    Axis,
    CenterArc,
    Circle,
    EllipticalCenterArc,
    Line,
    Plane,
    Shape,
    make_face,
    revolve,
    sweep,
)

from industnerf.parts.families.drawing import on_circle, rod, rods
from industnerf.parts.recipe import Recipe


def flanged_elbow(
    bore: float,
    wall: float,
    centre_to_face: float,
    flange: float,
    bolt_circle: float,
    bolts: int,
    bolt_hole: float,
) -> Shape:
    """Cast 90 degree elbow; the flange faces lie at z = 0 and at x = 0.

    Lengths after ISO 2531, flanges after EN 1092-2.
    """
    plate, raise_height, raised = 19.0, 3.0, 0.65 * flange
    bend = 0.6 * centre_to_face  # radius; straight to the flanges from there
    straight = centre_to_face - bend
    # drawn in the xz plane: up from the origin, round, and out along +x
    arc = Plane.XZ * CenterArc((bend, straight), bend, 90, 90)
    path = Line((0, 0, 0), (0, 0, straight)) + arc
    path += Line((bend, 0, centre_to_face), (centre_to_face, 0, centre_to_face))
    outlet = Plane((centre_to_face, 0, centre_to_face), x_dir=(0, 1, 0), z_dir=(-1, 0, 0))

    end = rod(flange, plate - raise_height, (0, 0, raise_height)) + rod(raised, plate)
    end -= rods(on_circle(bolts, bolt_circle, 180 / bolts), bolt_hole, plate)
    body = sweep(Plane.XY * Circle(bore / 2 + wall), path=path) + end + outlet * end
    return body - sweep(Plane.XY * Circle(bore / 2), path=path)


def welding_cap(outside: float, wall: float, length: float) -> Shape:
    """Butt-welding cap of ASME B16.9: a 2:1 semi-ellipsoid, a straight skirt, a welding bevel.

    The top of the skirt lies at z = 0.
    """
    radius, inner = outside / 2, outside / 2 - wall
    rise, root, bevel = outside / 4, 1.6, math.radians(37.5)
    skirt = length - rise
    bevel_height = (wall - root) * math.tan(bevel)
    inside_rise = rise - wall
    profile = [
        EllipticalCenterArc((0, 0), radius, rise),
        Line((0, rise), (0, inside_rise)),
        EllipticalCenterArc((0, 0), inner, inside_rise),
        Line((inner, 0), (inner, -skirt)),
        Line((inner, -skirt), (inner + root, -skirt)),
        Line((inner + root, -skirt), (radius, -skirt + bevel_height)),
        Line((radius, -skirt + bevel_height), (radius, 0)),
    ]
    return revolve(Plane.XZ * make_face(profile), axis=Axis.Z)


RECIPES = [
    Recipe(
        "elbow-flanged-dn65-pn16",
        "ISO 2531 flanged 90 deg elbow DN65 PN16-like",
        "build123d",
        flanged_elbow,
        {
            "bore": 65.0,
            "wall": 7.0,
            "centre_to_face": 165.0,
            "flange": 185.0,
            "bolt_circle": 145.0,
            "bolts": 4,
            "bolt_hole": 19.0,
        },
    ),
    Recipe(
        "pipe-cap-b16-9-nps4",
        "ASME B16.9 cap NPS 4 schedule 40-like",
        "build123d",
        welding_cap,
        {"outside": 114.3, "wall": 6.02, "length": 64.0},
    ),
]
