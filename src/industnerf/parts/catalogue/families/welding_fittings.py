"""Butt-welding fittings of ASME B16.9."""

import itertools
import math

from build123d import (
    Axis,
    Edge,
    EllipticalCenterArc,
    GeomType,
    Line,
    Plane,
    Rot,
    Shape,
    Spline,
    fillet,
    make_face,
    revolve,
)

from industnerf.parts.catalogue.families.drawing import Point, Real, bar, rod, turned
from industnerf.parts.catalogue.recipe import Recipe

ROOT_FACE, BEVEL = 1.6, math.radians(37.5)  # of a welding end, ASME B16.25, in mm


def beveled(outside: float, wall: float, end: Real, direction: int) -> list[Point]:
    """(radius, z) of a welding end at z = `end`, inside first; `direction` is towards its pipe."""
    inner = outside / 2 - wall
    bevel = (wall - ROOT_FACE) * math.tan(BEVEL)
    return [(inner, end), (inner + ROOT_FACE, end), (outside / 2, end + direction * bevel)]


def _lines(points: list[Point]) -> list[Edge]:
    return [Line(a, b) for a, b in itertools.pairwise(points)]


def welding_cap(outside: float, wall: float, length: float) -> Shape:
    """Cap: a 2:1 semi-ellipsoid, a straight skirt, a welding bevel.

    The top of the skirt lies at z = 0.
    """
    rise, skirt = outside / 4, length - outside / 4
    end = beveled(outside, wall, -skirt, 1)
    radius, inner = outside / 2, outside / 2 - wall
    profile = [
        EllipticalCenterArc((0, 0), radius, rise),
        Line((0, rise), (0, rise - wall)),
        EllipticalCenterArc((0, 0), inner, rise - wall),
        *_lines([(inner, 0), *end, (radius, 0)]),
    ]
    return revolve(Plane.XZ * make_face(profile), axis=Axis.Z)


def concentric_reducer(
    large: float, large_wall: float, small: float, small_wall: float, length: float
) -> Shape:
    """Concentric reducer along z: a smooth swage between two straight ends."""
    low, high, up = 0.16 * length, 0.88 * length, (0, 1)  # the swage's ends, and direction there
    bottom, top = beveled(large, large_wall, 0, 1), beveled(small, small_wall, length, -1)

    def swage(bottom_radius: Real, top_radius: Real) -> list[Edge]:
        ends = ((bottom_radius, low), (top_radius, high))
        return [Spline(*ends, tangents=(up, up), tangent_scalars=(1.2, 1.2))]

    inside, outside = (bottom[0][0], top[0][0]), (bottom[-1][0], top[-1][0])  # radii
    profile = swage(*inside) + swage(*outside)
    profile += _lines([(inside[0], low), *bottom, (outside[0], low)])
    profile += _lines([(inside[1], high), *top, (outside[1], high)])
    return revolve(Plane.XZ * make_face(profile), axis=Axis.Z)


def reducing_tee(
    run: float, run_wall: float, run_end: float, branch: float, branch_wall: float, reach: float
) -> Shape:
    """Reducing tee: run along z, the narrower branch drawn out along +x.

    `run_end` and `reach` are from the center to the ends of the run and of the branch.
    """
    crotch = 0.16 * branch  # outer radius where the branch is drawn out
    ends = [*beveled(run, run_wall, -run_end, 1), *beveled(run, run_wall, run_end, -1)[::-1]]
    neck = beveled(branch, branch_wall, reach, -1)[::-1]
    tee = turned([(0, -run_end), *ends, (0, run_end)])
    tee += Rot(0, 90, 0) * turned([(0, 0), (branch / 2, 0), *neck, (0, reach)])
    tee = fillet(tee.edges().filter_by(GeomType.BSPLINE), crotch)
    tee -= rod(run - 2 * run_wall, 2 * run_end, (0, 0, -run_end))
    return tee - bar(branch - 2 * branch_wall, reach, "x", (reach / 2, 0, 0))


RECIPES = [
    Recipe(
        "pipe-cap-b16-9-nps4",
        "ASME B16.9 cap NPS 4 schedule 40-like",
        "build123d",
        welding_cap,
        {"outside": 114.3, "wall": 6.02, "length": 64.0},
    ),
    Recipe(
        "reducer-b16-9-nps4x3",
        "ASME B16.9 concentric reducer NPS 4x3 schedule 40-like",
        "build123d",
        concentric_reducer,
        {"large": 114.3, "large_wall": 6.02, "small": 88.9, "small_wall": 5.49, "length": 102.0},
    ),
    Recipe(
        "tee-b16-9-nps3x2",
        "ASME B16.9 reducing tee NPS 3x2 schedule 40-like",
        "build123d",
        reducing_tee,
        {
            "run": 88.9,
            "run_wall": 5.49,
            "run_end": 86.0,
            "branch": 60.3,
            "branch_wall": 3.91,
            "reach": 76.0,
        },
        finish="bright steel",
    ),
]
