"""Pipes, flanged and threaded fittings; those to be welded are in `welding_fittings`."""

from bd_warehouse.pipe import Pipe
from build123d import CenterArc, Circle, Edge, Line, Plane, Pos, Rot, Shape, Sphere, sweep

from industnerf.parts.catalogue.families import welding_fittings
from industnerf.parts.catalogue.families.drawing import (
    faced_hexagon,
    raised_flange,
    rod,
    threaded,
    turned,
)
from industnerf.parts.catalogue.recipe import Assembly, Recipe


def flanged_elbow(
    bore: float,
    wall: float,
    center_to_face: float,
    flange: float,
    bolt_circle: float,
    bolts: int,
    bolt_hole: float,
) -> Shape:
    """Cast 90 degree elbow; the flange faces lie at z = 0 and at x = 0.

    Lengths after ISO 2531, flanges after EN 1092-2.
    """
    plate, bend = 19.0, 0.6 * center_to_face  # bend: radius; straight to the flanges from there
    straight = center_to_face - bend
    # drawn in the xz plane: up from the origin, round, and out along +x
    arc = Plane.XZ * CenterArc((bend, straight), bend, 90, 90)
    path = Line((0, 0, 0), (0, 0, straight)) + arc
    path += Line((bend, 0, center_to_face), (center_to_face, 0, center_to_face))
    outlet = Plane((center_to_face, 0, center_to_face), x_dir=(0, 1, 0), z_dir=(-1, 0, 0))

    end = raised_flange(flange, plate, bolt_circle, bolts, bolt_hole)
    body = sweep(Plane.XY * Circle(bore / 2 + wall), path=path) + end + outlet * end
    return body - sweep(Plane.XY * Circle(bore / 2), path=path)


def steel_pipe(nps: str, schedule: str, length: float) -> Shape:
    """Stainless pipe of ASME B36.19 along z, plain ends; `nps` in inches."""
    return Pipe(nps, "stainless", schedule, path=Edge.make_line((0, 0, 0), (0, 0, length)))


def threaded_cross(thread: float, pitch: float, center_to_end: float, band: float) -> Shape:
    """Forged cross of ASME B16.11 in the xz plane, a band round each female end."""
    body, band_height, bore, depth = 0.84 * band, 0.36 * band, 0.8 * thread, 0.36 * band
    shoulder = center_to_end - band_height
    arm = turned(
        [
            (0, 0),
            (body / 2, 0),
            (body / 2, shoulder - 2),
            (band / 2, shoulder + 2),
            (band / 2, center_to_end - 2),
            (band / 2 - 2, center_to_end),
            (0, center_to_end),
        ]
    )
    mouth = [(0, center_to_end - 2), (thread / 2 - 1.5, center_to_end - 2)]
    mouth += [(thread / 2 + 0.5, center_to_end), (0, center_to_end)]
    inside = rod(bore, center_to_end) + turned(mouth)
    inside += threaded(thread, pitch, depth, (0, 0, center_to_end - depth))
    turns = [Rot(0, 90 * i, 0) for i in range(4)]
    return Sphere(0.56 * body) + [turn * arm for turn in turns] - [turn * inside for turn in turns]


def hexagon_union(thread: float, pitch: float, flats: float, nut: float) -> Assembly:
    """Pipe union along z, in three pieces: two ends with female threads and the nut over them."""
    end, depth, nut_height = 0.55 * flats, 0.6 * flats, 0.62 * flats
    gap = 0.16 * flats  # the lower end's own thread shows below the nut
    nut_base, top = end + gap, end + gap + nut_height + 0.6 * flats
    tapped = threaded(thread, pitch, depth) + rod(0.85 * thread, top)
    tapped += Pos(0, 0, top - depth) * threaded(thread, pitch, depth)
    ends = faced_hexagon(flats, end) + threaded(0.98 * flats, pitch, top - end - depth, (0, 0, end))
    ends += faced_hexagon(flats, 0.5 * flats, (0, 0, top - 0.5 * flats))
    ends += rod(0.95 * flats, top - nut_base - 2, (0, 0, nut_base))
    cover = faced_hexagon(nut, nut_height, (0, 0, nut_base)) - rod(0.94 * flats, top)
    return Assembly({"bright steel": ends - tapped, "brass": cover})


RECIPES = [
    Recipe(
        "cross-threaded-b16-11-nps1",
        "ASME B16.11 threaded cross NPS 1 class 3000-like",
        "build123d",
        threaded_cross,
        {"thread": 33.2, "pitch": 2.21, "center_to_end": 44.5, "band": 56.0},
        finish="black oxide",
    ),
    Recipe(
        "elbow-flanged-dn65-pn16",
        "ISO 2531 flanged 90 deg elbow DN65 PN16-like",
        "build123d",
        flanged_elbow,
        {
            "bore": 65.0,
            "wall": 7.0,
            "center_to_face": 165.0,
            "flange": 185.0,
            "bolt_circle": 145.0,
            "bolts": 4,
            "bolt_hole": 19.0,
        },
        finish="blue paint",
    ),
    Recipe(
        "pipe-b36-19-nps3-sch40s",
        "ASME B36.19 NPS 3 schedule 40S, length 200",
        "bd_warehouse",
        steel_pipe,
        {"nps": "3", "schedule": "40S", "length": 200.0},
        finish="bright steel",
    ),
    Recipe(
        "union-hexagon-g1-2",
        "three-piece pipe union G 1/2",
        "build123d",
        hexagon_union,
        {"thread": 20.96, "pitch": 1.814, "flats": 30.0, "nut": 41.0},
    ),
    *welding_fittings.RECIPES,
]
