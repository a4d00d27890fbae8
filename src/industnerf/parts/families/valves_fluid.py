"""Valves and fluid power."""

from build123d import Pos, Rot, Shape, Sphere

from industnerf.parts.families.drawing import bar, block, hexagon, rod, rods, slot, upright
from industnerf.parts.recipe import Recipe

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


def ball_valve(bore: float, thread_core: float, length: float, lever: float) -> Shape:
    """Two-piece threaded ball valve, drawn open; the pipe runs along x, the stem along z."""
    hexagon_flats, hexagon_length = 1.4 * thread_core, 0.22 * length
    globe, barrel, tower, stem = 2.3 * bore, 1.75 * bore, 1.15 * bore, 0.55 * bore
    tower_top = 0.5 * globe + 0.45 * bore
    plate = 3.0  # sheet of the lever

    along_x = Rot(0, 90, 0)
    body = Sphere(globe / 2) + bar(barrel, length, "x")
    for start in (-length / 2, length / 2 - hexagon_length):
        body += Pos(start, 0, 0) * along_x * hexagon(hexagon_flats, hexagon_length)
    body += bar(1.12 * barrel, 0.08 * length, "x", (0.2 * length, 0, 0))  # joint of the two pieces
    body += rod(tower, tower_top)
    body += hexagon(1.1 * tower, 0.3 * bore, (0, 0, tower_top))  # packing nut
    body += rod(stem, 0.95 * bore, (0, 0, tower_top))

    low, high = tower_top + 0.45 * bore, tower_top + 1.0 * bore
    bend = (0.9 * bore, 1.6 * bore)
    handle = upright(
        [
            (-0.6 * bore, low),
            (bend[0], low),
            (bend[1], high),
            (lever, high),
            (lever, high + plate),
            (bend[1] - 0.3 * plate, high + plate),
            (bend[0] - 0.3 * plate, low + plate),
            (-0.6 * bore, low + plate),
        ],
        1.1 * bore,
    )
    handle &= slot(lever + 0.6 * bore, 1.1 * bore, 2 * high, ((lever - 0.6 * bore) / 2, 0, 0))
    handle -= rod(0.45 * bore, 2 * high, (lever - 0.55 * bore, 0, 0))
    body += handle
    body += hexagon(0.75 * bore, 0.35 * bore, (0, 0, low + plate))
    body -= bar(bore, length, "x")
    for end in (-length / 2, length / 2):
        body -= bar(thread_core, 2 * hexagon_length, "x", (end, 0, 0))
    return body


RECIPES = [
    Recipe(
        "ball-valve-g1-2",
        "2-piece ball valve DN15 G 1/2",
        "build123d",
        ball_valve,
        {"bore": 15.0, "thread_core": 18.6, "length": 60.0, "lever": 95.0},
    ),
    Recipe(
        "manifold-iso4401-03-3",
        "ISO 4401-03 (NG6) manifold-like, 3 stations",
        "build123d",
        valve_manifold,
        {"stations": 3},
    ),
]
