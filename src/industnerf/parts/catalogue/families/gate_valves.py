"""Gate valves."""

from build123d import Axis, Ellipse, Pos, Rot, Shape, Torus, extrude, fillet

from industnerf.parts.catalogue.families.drawing import (
    Point,
    bar,
    copies_on_circle,
    faced_hexagon,
    on_grid,
    raised_flange,
    rod,
    rods,
    rounded_block,
    slot,
    threaded,
    turned,
)
from industnerf.parts.catalogue.recipe import Assembly, MeshBoolean, Recipe


def gate_valve(
    bore: float, face_to_face: float, flange: float, bolt_circle: float, bolt_hole: float
) -> Assembly:
    """Flanged cast-iron gate valve, drawn open; the pipe runs along x, the spindle along z.

    Face to face after EN 558 series 14, flanges after EN 1092-2.
    """
    plate, cover = 19.0, (2.1 * bore, 1.6 * bore, 12.0)
    joint, neck, wheel = 1.5 * bore, 2.9 * bore, 3.9 * bore  # levels on the spindle's axis
    stem_thread, bolt, flats, nut = 4.0, 10.0, 16.0, 8.0  # flats and height of the bolts' nuts

    body = bar(1.36 * bore, face_to_face - plate, "x")
    end = Pos(0, 0, -face_to_face / 2) * raised_flange(flange, plate, bolt_circle, 4, bolt_hole)
    body += [Rot(0, turn, 0) * end for turn in (90, -90)]
    bowl = extrude(Ellipse(0.8 * bore, 0.6 * bore), joint + 0.8 * bore)
    body += Pos(0, 0, -0.8 * bore) * fillet(bowl.edges().group_by(Axis.Z)[0], 0.3 * bore)
    body += rounded_block(*cover, 14.0, (0, 0, joint - cover[2]))
    body -= bar(bore, face_to_face, "x")
    bonnet = rounded_block(*cover, 14.0, (0, 0, joint + 1)) + turned(_bonnet(bore, joint, neck))
    bonnet += slot(1.5 * bore, 0.5 * bore, 0.16 * bore, (0, 0, neck + 0.12 * bore))  # gland

    fasteners = threaded(0.36 * bore, stem_thread, wheel - neck + 0.24 * bore, (0, 0, neck))
    fasteners += rods([(s * 0.56 * bore, 0) for s in (1, -1)], 8.0, 0.5 * bore, neck - 0.1 * bore)
    for x, y in on_grid(cover[0] - 23, cover[1] - 23):
        fasteners += rod(bolt, 2 * cover[2] + 2 * bolt, (x, y, joint - cover[2] - bolt))
        fasteners += faced_hexagon(flats, nut, (x, y, joint + cover[2] + 0.5))
        fasteners += faced_hexagon(flats, nut, (x, y, joint - cover[2] - nut + 0.5))
    gasket = rod(1.1 * bore, 2.0, (0, 0, joint - 0.5))
    return Assembly(
        {
            "blue paint": body + bonnet + gasket,
            "zinc": fasteners,
            "red paint": MeshBoolean(_hand_wheel(2.4 * bore, 0.44 * bore, wheel), []),
        }
    )


def _bonnet(bore: float, joint: float, neck: float) -> list[Point]:
    """Of a gate valve, (radius, z): from the cover at `joint` up to the stuffing box at `neck`."""
    cone, box = 0.62 * bore, 0.34 * bore  # radii
    return [
        (0, joint + 2),
        (cone, joint + 2),
        (cone, joint + 0.4 * bore),
        (box, joint + 0.85 * bore),
        (box, neck - 0.3 * bore),
        (0.8 * bore, neck - 0.3 * bore),
        (0.8 * bore, neck - 0.1 * bore),
        (box, neck - 0.1 * bore),
        (box, neck + 0.15 * bore),
        (0, neck + 0.15 * bore),
    ]


def _hand_wheel(diameter: float, hub: float, level: float) -> list[Shape]:
    """Rim, hub and four spokes.  To be united as meshes: OpenCASCADE loses tori."""
    rim, spoke = 0.11 * diameter, 0.08 * diameter
    mean = diameter - rim
    spokes = copies_on_circle(4, bar(spoke, 0.5 * mean, "x", (0.25 * mean, 0, 0)), 45)
    return [
        Pos(0, 0, level) * body
        for body in (Torus(mean / 2, rim / 2), rod(hub, 1.4 * rim, (0, 0, -0.7 * rim)), *spokes)
    ]


RECIPES = [
    Recipe(
        "gate-valve-dn50-pn16",
        "EN 1171 flanged gate valve DN50 PN16-like",
        "build123d",
        gate_valve,
        {
            "bore": 50.0,
            "face_to_face": 150.0,
            "flange": 165.0,
            "bolt_circle": 125.0,
            "bolt_hole": 19.0,
        },
    )
]
