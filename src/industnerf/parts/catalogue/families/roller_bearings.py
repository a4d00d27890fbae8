"""Roller bearings: boundary dimensions of ISO 15 and ISO 355, the inside drawn by us.

A bearing stands on z = 0, about z, and has play, as the ball bearings have.
"""

import math

from build123d import Pos, Rot, Shape

from industnerf.parts.catalogue.families.ball_bearings import PLAY, assembled
from industnerf.parts.catalogue.families.drawing import (
    Point,
    Real,
    copies_on_circle,
    half_section,
    spun,
    turned,
)
from industnerf.parts.catalogue.recipe import Assembly, Recipe


def roller(large: Real, small: Real, length: Real, chamfer: Real) -> Shape:
    """On the plane z = 0, from its `large` diameter to its `small` one."""
    a, b = large / 2, small / 2
    side = [(a, chamfer), (b, length - chamfer)]
    return turned([(0, 0), (a - chamfer, 0), *side, (b - chamfer, length), (0, length)])


def cylindrical_roller_bearing(
    bore: float, outside: float, width: float, raceway: float, barrel: float, rollers: int
) -> Assembly:
    """Form NU: two ribs on the outer ring, none on the inner one, whose `raceway` this is.

    `barrel` is the diameter of the rollers.
    """
    pitch, length = raceway + barrel, 0.6 * width
    low, slack = (width - length) / 2, 0.1
    inner = half_section(bore, raceway, 0, width, 0.05 * width)
    outer = half_section(pitch + 0.6 * barrel, outside, 0, width, 0.05 * width)
    outer -= half_section(pitch, pitch + barrel, low - slack, width - low + slack)
    cage = half_section(pitch - 0.36 * barrel, pitch + 0.36 * barrel, 0.06 * width, 0.94 * width)
    free = (1 - 2 * PLAY) * barrel
    standing = Pos(pitch / 2, 0, low) * roller(free, free, length, 0.07 * barrel)
    return assembled([spun(inner), spun(outer)], copies_on_circle(rollers, standing), spun(cage))


def taper_roller_bearing(
    bore: float,
    outside: float,
    total: float,
    cone: float,
    cup: float,
    mouth: float,
    contact: float,
    rollers: int,
) -> Assembly:
    """The cone with its large rib on z = 0, and the cup, whose back face is at z = `total`.

    `cone` and `cup` are widths, `mouth` and `contact` the small diameter and the angle of the
    cup's raceway (ISO 355: T, B, C, E, alpha).  Raceways and rollers share one apex on the axis.
    """
    half_cone, hem = 1.8, 1.2  # of a roller, degrees; of the cage beyond the rollers, mm
    slack = 0.1  # mm, at the ends of the rollers
    tilt = math.radians(contact - half_cone)
    taper = math.tan(math.radians(half_cone))
    apex = total + mouth / 2 / math.tan(math.radians(contact))
    center, length = (apex - total + cup / 2) / math.cos(tilt), 0.75 * cup
    near, far = center - length / 2, center + length / 2  # a roller's ends, from the apex

    def flank_point(along: Real, roundness: Real) -> Point:
        """The point `along` a roller's axis, and beside it by `roundness` times its radius."""
        off = roundness * along * taper
        radius = along * math.sin(tilt) + off * math.cos(tilt)
        return radius, apex - along * math.cos(tilt) + off * math.sin(tilt)

    clear = 1 + 2 * PLAY
    top, bottom = far + slack, near - slack
    rib, lip = flank_point(top, -0.3), flank_point(bottom, -0.6)
    corner = 0.06 * total
    cup_face = total - cup
    cup_ring = turned(
        [
            (outside / 2, total - corner),
            (outside / 2 - corner, total),
            (mouth / 2, total),
            ((apex - cup_face) * math.tan(math.radians(contact)), cup_face),
            (outside / 2, cup_face),
        ]
    )
    cone_ring = turned(
        [
            (bore / 2, corner),
            (bore / 2 + corner, 0),
            (rib[0], 0),
            rib,
            flank_point(top, -clear),
            flank_point(bottom, -clear),
            lip,
            (lip[0], cone),
            (bore / 2, cone),
        ]
    )
    sheet = [(near - hem, 0.1), (far + hem, 0.1), (far + hem, 0.4), (near - hem, 0.4)]
    cage = turned([flank_point(along, roundness) for along, roundness in sheet])
    location = Pos(0, 0, apex) * Rot(0, 180 - math.degrees(tilt), 0)  # from the apex, down and out
    free = 2 * (1 - 3 * PLAY) * taper  # a smaller gap is lost in the facets
    lying = roller(free * near, free * far, length, 0.05 * length)
    rolling = copies_on_circle(rollers, location * Pos(0, 0, near) * lying)
    return assembled([cup_ring, cone_ring], rolling, cage)


RECIPES = [
    Recipe(
        "bearing-roller-nu205",
        "ISO 15 NU205 25x52x15",
        "build123d",
        cylindrical_roller_bearing,
        {
            "bore": 25.0,
            "outside": 52.0,
            "width": 15.0,
            "raceway": 31.5,
            "barrel": 7.5,
            "rollers": 13,
        },
    ),
    Recipe(
        "bearing-taper-30206",
        "ISO 355 30206 30x62x17.25",
        "build123d",
        taper_roller_bearing,
        {
            "bore": 30.0,
            "outside": 62.0,
            "total": 17.25,
            "cone": 16.0,
            "cup": 14.0,
            "mouth": 49.99,
            "contact": 14.036,
            "rollers": 17,
        },
    ),
]
