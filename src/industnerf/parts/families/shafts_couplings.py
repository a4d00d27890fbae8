"""Shafts and couplings."""

from bd_warehouse.open_builds import FlexibleCoupler
from build123d import Pos, Rot, Shape

from industnerf.parts.families.drawing import rod, slot, turned
from industnerf.parts.recipe import Recipe


def helical_beam_coupler(bore: str) -> Shape:
    """OpenBuilds flexible coupler, 5 mm to `bore`."""
    return FlexibleCoupler(bore)


def keyseat(diameter: float, width: float, depth: float, length: float, middle: float) -> Shape:
    """What an end mill takes out of a shaft along z at +x, for a round-ended key (DIN 6885-1 A)."""
    return Pos(diameter, 0, middle) * Rot(0, -90, 0) * slot(length, width, diameter / 2 + depth)


def stepped_shaft(seat: float) -> Shape:
    """Transmission shaft along z: two bearing seats, a gear seat against a collar, an end seat.

    Keyways of DIN 6885-1 for the 40 mm and 25 mm seats when `seat` is 30, groove of DIN 471,
    undercuts before the shoulders, centre holes of DIN 332.
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
    centre = turned([(0, -1), (4, -1), (4, 0), (1.6, 4), (1.6, 7), (0, 8)])
    return shaft - centre - Pos(0, 0, z) * Rot(180, 0, 0) * centre


RECIPES = [
    Recipe(
        "coupler-helical-beam-8mm",
        "OpenBuilds flexible coupler 5x8",
        "bd_warehouse",
        helical_beam_coupler,
        {"bore": "8mm"},
    ),
    Recipe(
        "shaft-stepped-d30",
        "shaft d30 with DIN 6885-1 A-like keyways",
        "build123d",
        stepped_shaft,
        {"seat": 30.0},
    ),
]
