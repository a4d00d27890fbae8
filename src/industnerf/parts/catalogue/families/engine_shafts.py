"""Crankshaft and camshaft of a four-cylinder engine; both turn about z, the nose at the bottom."""

from build123d import Circle, Pos, Rot, Shape, extrude

from industnerf.parts.catalogue.families.drawing import (
    Real,
    bar,
    chamfered_rod,
    fused,
    on_circle,
    polygon,
    rod,
    rods,
    tangent_hull,
    turned,
)
from industnerf.parts.catalogue.recipe import Recipe

CRANK_ANGLES = (0, 180, 180, 0)  # degrees, of the throws from the nose
CAM_ANGLES = (0, 270, 90, 180)  # of the cylinders' cams: they fire 1-3-4-2


def crank_web(main: Real, pin: Real, throw: Real, thickness: Real) -> Shape:
    """The cheek from the main journal to the pin above it, with a fan-shaped counterweight."""
    cheek = tangent_hull((0, 0), 0.68 * main, (0, throw), 0.66 * pin)
    reach = 5 * throw
    fan = Circle(1.6 * throw) & polygon([(0, main), (-reach, -0.5 * reach), (reach, -0.5 * reach)])
    return extrude(cheek + fan, thickness)


def crank_throw(main: Real, pin: Real, throw: Real, web: Real, gap: Real) -> list[Shape]:
    """Two webs, the lower at z = 0, the pin `gap` long between them, shoulders for the rods."""
    shoulder, top = 1.2, web + gap
    bodies = [Pos(0, 0, z) * crank_web(main, pin, throw, web) for z in (0, top)]
    bodies += [rod(pin, gap + web, (0, throw, web / 2))]
    for z in (web, top):
        bodies += [rod(1.15 * pin, 2 * shoulder, (0, throw, z - shoulder))]
    for z in (0, top + web):
        bodies += [rod(1.15 * main, 2 * shoulder, (0, 0, z - shoulder))]
    return bodies


def crankshaft(main: Real, pin: Real, stroke: Real, pitch: Real, nose: Real) -> Shape:
    """Four throws in one plane, five main journals, a stepped nose with its key seat, a flange.

    `pitch` is that of the cylinders.  The first main journal begins at z = 0.
    """
    web, bearing, gap = 0.17 * pitch, 0.32 * pitch, 0.34 * pitch
    end, flange, plate = 4 * pitch + bearing, 1.5 * main, 0.2 * main
    join = [rod(main, bearing + 1), rod(main, bearing + web, (0, 0, end - bearing - web / 2))]
    join += [rod(main, bearing + web, (0, 0, i * pitch - web / 2)) for i in (1, 2, 3)]
    join += [chamfered_rod(flange, plate, 1.0, (0, 0, end))]
    join += [chamfered_rod(nose, 1.6 * nose + 2, 1.0, (0, 0, -1.6 * nose))]
    cut = rods(on_circle(6, 0.72 * flange), 0.1 * flange, 2 * plate, end + 2)
    cut += [rod(0.34 * flange, plate, (0, 0, end + 0.4 * plate))]  # pilot of the gearbox shaft
    cut += [rod(0.4 * nose, nose, (0, 0, -2 * nose))]  # bolt of the belt wheel
    key = Pos(nose * 0.95, 0, -0.9 * nose) * bar(nose, 0.2 * nose, "y")  # a Woodruff key's seat
    for i, angle in enumerate(CRANK_ANGLES):
        at = Pos(0, 0, i * pitch + bearing) * Rot(0, 0, angle)
        join += [at * body for body in crank_throw(main, pin, stroke / 2, web, gap)]
        oil = bar(0.11 * pin, 2 * pin, "x", (pin, stroke / 2, web + gap / 2))
        cut += [at * oil, bar(0.11 * main, main, "y", (0, main / 2, i * pitch + bearing / 2))]
    return fused(join) - cut - key


def camshaft(shaft: Real, base: Real, lift: Real, pitch: Real) -> Shape:
    """Eight cams, five journals between and beside them, a thrust collar and a wheel seat below.

    Each cylinder has two cams 110 degrees apart; flanks are the tangents of base and nose circle.
    """
    journal, width, bearing, nose = 1.3 * base, 0.2 * pitch, 0.24 * pitch, 0.2 * base
    end = 4 * pitch + bearing
    lobe = extrude(tangent_hull((0, 0), base / 2, (0, base / 2 + lift - nose), nose), width)
    join = [rod(shaft, end)]
    for i in range(5):
        join += [chamfered_rod(journal, bearing, 0.8, (0, 0, i * pitch))]
    for i, angle in enumerate(CAM_ANGLES):
        middle = i * pitch + (pitch + bearing) / 2
        for offset, phase in ((-0.21, 0), (0.21, 110)):
            low = middle + offset * pitch - width / 2
            join += [Pos(0, 0, low) * Rot(0, 0, angle + phase) * lobe]
    collar, seat = 0.08 * pitch, 0.3 * pitch
    join += [chamfered_rod(1.5 * base, collar, 0.8, (0, 0, -2 * collar))]
    join += [chamfered_rod(shaft, seat + 1, 1.0, (0, 0, -2 * collar - seat))]
    join += [rod(shaft, 3 * collar, (0, 0, -2 * collar))]
    screw = turned([(0, -1), (0.26 * shaft, -1), (0.2 * shaft, 2), (0.2 * shaft, seat), (0, seat)])
    dowel = rod(0.16 * shaft, collar, (0.57 * base, 0, -2.5 * collar))
    return fused(join) - Pos(0, 0, -2 * collar - seat) * screw - dowel


RECIPES = [
    Recipe(
        "crankshaft-4-throw",
        "four-throw crankshaft, stroke 76, mains 50, pins 44",
        "build123d",
        crankshaft,
        {"main": 50.0, "pin": 44.0, "stroke": 76.0, "pitch": 88.0, "nose": 30.0},
    ),
    Recipe(
        "camshaft-8-lobe",
        "eight-lobe camshaft, base circle 36, lift 11",
        "build123d",
        camshaft,
        {"shaft": 26.0, "base": 36.0, "lift": 11.0, "pitch": 66.0},
    ),
]
