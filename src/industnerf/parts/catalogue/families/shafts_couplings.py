"""Shafts and couplings."""

from bd_warehouse.open_builds import FlexibleCoupler
from build123d import Circle, Pos, Rectangle, Rot, Shape, extrude

from industnerf.parts.catalogue.families import couplings, engine_shafts, joints
from industnerf.parts.catalogue.families.drawing import (
    Real,
    chamfered_rod,
    copies_on_circle,
    rod,
    slot,
    tube,
    turned,
)
from industnerf.parts.catalogue.recipe import Recipe


def helical_beam_coupler(bore: str) -> Shape:
    """OpenBuilds flexible coupler, 5 mm to `bore`."""
    return FlexibleCoupler(bore)


def keyseat(diameter: Real, width: Real, depth: Real, length: Real, middle: Real) -> Shape:
    """What an end mill takes out of a shaft along z at +x, for a round-ended key (DIN 6885-1 A)."""
    return Pos(diameter, 0, middle) * Rot(0, -90, 0) * slot(length, width, diameter / 2 + depth)


def stepped_shaft(seat: Real) -> Shape:
    """Transmission shaft along z: two bearing seats, a gear seat against a collar, an end seat.

    Keyways of DIN 6885-1 for the 40 mm and 25 mm seats when `seat` is 30, groove of DIN 471,
    undercuts before the shoulders, center holes of DIN 332.
    """
    end, gear, collar = seat - 5, seat + 10, seat + 20
    undercut, edge = 0.4, 1.0
    steps = [(end, 52), (seat, 30), (gear, 62), (collar, 8), (seat + 6, 12), (seat, 26)]
    profile, z = [(0.0, 0.0), (end / 2 - edge, 0.0), (end / 2, edge)], 0.0
    for (diameter, length), (following, _) in zip(steps, [*steps[1:], (0.0, 0.0)], strict=True):
        z += length
        if following > diameter:  # the step ends at a shoulder: relieve its corner
            profile += [(diameter / 2, z - 2.5), (diameter / 2 - undercut, z - 2.0)]
            profile += [(diameter / 2 - undercut, z), (following / 2 - edge, z)]
            profile += [(following / 2, z + edge)]
        else:
            profile += [(diameter / 2, z - edge), (diameter / 2 - edge, z)]
            profile += [(following / 2, z)]
    shaft = turned(profile)
    shaft -= keyseat(gear, 12, 5, 45, 52 + 30 + 31)
    shaft -= keyseat(end, 8, 4, 40, 25)
    groove = z - 4.0
    shaft -= rod(seat, 1.6, (0, 0, groove)) - rod(seat - 1.4, 1.6, (0, 0, groove))
    center = turned([(0, -1), (4, -1), (4, 0), (1.6, 4), (1.6, 7), (0, 8)])
    return shaft - center - Pos(0, 0, z) * Rot(180, 0, 0) * center


def splined_shaft(inner: Real, outer: Real, splines: int, width: Real, length: Real) -> Shape:
    """Straight-sided splines of ISO 14 from z = 0, a collar above them, a seat and a thin end."""
    section = Circle(inner / 2) + copies_on_circle(
        splines, Pos(outer / 4, 0) * Rectangle(outer / 2, width)
    )
    toothed = extrude(section, length) & chamfered_rod(outer, length + outer, 1.5)
    undercut, collar, seat = 0.25 * inner, 1.3 * outer, 0.95 * inner
    steps = [(inner - 1.0, undercut), (collar, 0.25 * outer), (seat, outer), (0.85 * seat, inner)]
    shaft, z = toothed, length
    for diameter, height in steps:
        shaft += chamfered_rod(diameter, height, 0.8, (0, 0, z))
        z += height
    groove = tube(seat, 0.94 * seat, 1.85, (0, 0, z - inner - 3.5))
    center = turned([(0, -1), (4, -1), (4, 0), (1.6, 4), (1.6, 7), (0, 8)])
    return shaft - groove - center - Pos(0, 0, z) * Rot(180, 0, 0) * center


RECIPES = [
    Recipe(
        "coupler-helical-beam-8mm",
        "OpenBuilds flexible coupler 5x8",
        "bd_warehouse",
        helical_beam_coupler,
        {"bore": "8mm"},
        finish="aluminum",
    ),
    Recipe(
        "shaft-stepped-d30",
        "shaft d30 with DIN 6885-1 A-like keyways",
        "build123d",
        stepped_shaft,
        {"seat": 30.0},
    ),
    Recipe(
        "shaft-splined-8x36x40",
        "ISO 14 8x36x40 splined shaft, 90 of splines",
        "build123d",
        splined_shaft,
        {"inner": 36.0, "outer": 40.0, "splines": 8, "width": 7.0, "length": 90.0},
    ),
    *engine_shafts.RECIPES,
    *couplings.RECIPES,
    *joints.RECIPES,
]
