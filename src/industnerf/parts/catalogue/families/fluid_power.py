"""Manifolds and cylinders of fluid power."""

from build123d import Axis, Shape, chamfer

from industnerf.parts.catalogue.families.drawing import (
    bar,
    block,
    faced_hexagon,
    on_grid,
    rod,
    rods,
    rounded_block,
    threaded,
)
from industnerf.parts.catalogue.recipe import Assembly, MeshBoolean, Recipe

# ISO 4401-03 (NG6): the mounting face of a directional valve, from its bolt F1, in mm
BOLTS = [(0.0, 0.0), (40.5, 0.0), (40.5, 31.75), (0.0, 31.0)]
PORT_P, PORT_A, PORT_T, PORT_B = (21.5, 25.9), (12.7, 15.5), (21.5, 5.1), (30.2, 15.5)
PORT_DIAMETER, BOLT_CORE = 7.5, 4.2  # M5


def valve_manifold(stations: int) -> Shape:
    """Subplate for NG6 valves side by side, with common P and T galleries along x.

    The valve faces lie on top, the working ports A and B (G 3/8) in front.  Levels are chosen so
    that no two drillings meet but those that should.
    """
    pitch, depth, height = 50.0, 70.0, 75.0
    f1_x, f1_y = 4.75, 22.0  # of the bolt F1, from the station's left edge and from the front
    gallery, working, thread, thread_depth, spot_face = 11.0, 9.0, 15.2, 12.0, 23.0
    level_p, level_t, level_a, level_b = 15.0, 52.0, 13.0, 37.0
    length = stations * pitch
    body = block(length, depth, height, (length / 2, depth / 2, 0))

    for (_, port_y), level in ((PORT_P, level_p), (PORT_T, level_t)):
        body -= bar(gallery, length, "x", (length / 2, f1_y + port_y, level))
        for end in (0, length):
            body -= bar(thread, 2 * thread_depth, "x", (end, f1_y + port_y, level))
    for x, y in ((station * pitch + f1_x, f1_y) for station in range(stations)):
        body -= rods([(x + dx, y + dy) for dx, dy in BOLTS], BOLT_CORE, 15, height - 15)
        for (dx, dy), level in ((PORT_P, level_p), (PORT_T, level_t)):
            body -= rod(PORT_DIAMETER, height - level, (x + dx, y + dy, level))
        for (dx, dy), level in ((PORT_A, level_a), (PORT_B, level_b)):
            body -= rod(PORT_DIAMETER, height - level, (x + dx, y + dy, level))
            body -= bar(working, 2 * (y + dy), "y", (x + dx, 0, level))
            body -= bar(thread, 2 * thread_depth, "y", (x + dx, 0, level))
            body -= bar(spot_face, 2.0, "y", (x + dx, 0, level))
    feet = [(i * pitch, y) for i in range(1, stations) for y in (10, 62)]
    return body - rods(feet, 5.0, 12)  # M6 from below


def tie_rod_cylinder(bore: float, piston_rod: float, stroke: float, ties: float) -> Assembly:
    """Hydraulic cylinder along z: square heads, four tie rods, an eye behind, a thread in front.

    Mounting MP3 of ISO 6020-2, the rod drawn in; its shoulder lies on z = 0.
    """
    side, head, tie, eye = 1.6 * bore, 1.1 * bore, 0.2 * bore, 1.1 * bore
    gland_face = -0.7 * bore
    front = gland_face - 0.35 * bore  # face of the front head
    back = front - 2 * head - stroke - 0.6 * bore  # face of the rear head
    pivot = back - 0.75 * eye

    heads = rod(1.05 * bore, gland_face - front, (0, 0, front))
    for face in (front - head, back):
        heads += chamfer(block(side, side, head, (0, 0, face)).edges().filter_by(Axis.Z), 3.0)
    heads += block(eye, 0.6 * eye, back - pivot, (0, 0, pivot))
    heads += bar(eye, 0.6 * eye, "y", (0, 0, pivot))
    heads -= bar(0.5 * bore, eye, "y", (0, 0, pivot))
    for level in (front - 0.5 * head, back + 0.5 * head):
        port = (0, -side / 2, level)
        heads -= bar(0.62 * head, 1.0, "y", port) + bar(0.38 * head, 0.8 * bore, "y", port)

    thread, flats = 0.8 * piston_rod, 0.82 * piston_rod
    shaft = rod(piston_rod, -gland_face, (0, 0, gland_face))
    shaft -= [
        block(piston_rod, piston_rod, 0.25 * bore, (s * (flats + piston_rod) / 2, 0, -0.4 * bore))
        for s in (1, -1)
    ]
    shaft += threaded(thread, 1.5, 1.4 * thread)
    fasteners = rods(on_grid(ties, ties), tie, front - back + 2.4 * tie, back - 1.2 * tie)
    for x, y in on_grid(ties, ties):
        for level in (front, back - 0.8 * tie):
            fasteners += [faced_hexagon(1.63 * tie, 0.8 * tie, (x, y, level))]
    tube = rod(1.28 * bore, front - back - 2 * head + 4, (0, 0, back + head - 2))
    return Assembly(
        {
            "blue paint": tube,
            "black oxide": heads,
            "bright steel": shaft,
            "zinc": MeshBoolean(fasteners, []),
        }
    )


def compact_cylinder(side: float, bolt_pitch: float, piston_rod: float, stroke: float) -> Assembly:
    """Pneumatic cylinder of ISO 21287 along z, its rod drawn in; the front face lies on z = 0.

    Grooves for sensors along three sides of the barrel, ports on the fourth.
    """
    cap, groove, thread = 14.0, 5.0, 0.83 * piston_rod  # groove: of sensors, a round one
    length = 44.0 + stroke
    barrel = rounded_block(side, side, length - 2 * cap, 3.0, (0, 0, cap - length))
    inset = side / 2 - 0.4 * groove
    rows = [(s * inset, y) for s in (1, -1) for y in (-6, 6)] + [(x, inset) for x in (-6, 6)]
    barrel -= rods(rows, groove, length, -length)

    caps = rounded_block(side, side, cap, 5.0, (0, 0, -cap))
    caps += rounded_block(side, side, cap, 5.0, (0, 0, -length))
    caps += rod(1.6 * piston_rod, 2.0)
    caps -= rod(14.0, 2.1, (0, 0, -length))
    corners = on_grid(bolt_pitch, bolt_pitch)
    caps -= rods(corners, 5.0, cap + 1, -cap) + rods(corners, 5.0, cap, -length)
    caps -= [bar(8.6, 20.0, "y", (0, -side / 2, z)) for z in (-cap / 2, cap / 2 - length)]
    shaft = rod(piston_rod, 7.0) + threaded(thread, 1.25, 16.0, (0, 0, 7.0))
    flats = 0.83 * piston_rod
    shaft -= [block(9, 20, 4.0, (s * (flats + 9) / 2, 0, 2.5)) for s in (1, -1)]
    return Assembly({"aluminum": barrel, "black oxide": caps, "bright steel": shaft})


RECIPES = [
    Recipe(
        "cylinder-compact-iso21287-32x40",
        "ISO 21287 compact cylinder 32x40-like",
        "build123d",
        compact_cylinder,
        {"side": 49.0, "bolt_pitch": 32.5, "piston_rod": 12.0, "stroke": 40.0},
    ),
    Recipe(
        "cylinder-tie-rod-iso6020-40x60",
        "ISO 6020-2 MP3 hydraulic cylinder 40x22x60-like",
        "build123d",
        tie_rod_cylinder,
        {"bore": 40.0, "piston_rod": 22.0, "stroke": 60.0, "ties": 41.7},
    ),
    Recipe(
        "manifold-iso4401-03-3",
        "ISO 4401-03 (NG6) manifold-like, 3 stations",
        "build123d",
        valve_manifold,
        {"stations": 3},
        finish="aluminum",
    ),
]
