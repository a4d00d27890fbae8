"""Ball valves and nozzles; also `gate_valves`, and manifolds and cylinders in `fluid_power`."""

import math

from build123d import Pos, Rot, Shape, Sphere

from industnerf.parts.catalogue.families import fluid_power, gate_valves
from industnerf.parts.catalogue.families.drawing import (
    bar,
    faced_hexagon,
    hexagon,
    rod,
    slot,
    threaded,
    upright,
)
from industnerf.parts.catalogue.recipe import Assembly, Recipe


def ball_valve(bore: float, thread_core: float, length: float, lever: float) -> Assembly:
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
    body -= bar(bore, length, "x")
    for end in (-length / 2, length / 2):
        body -= bar(thread_core, 2 * hexagon_length, "x", (end, 0, 0))

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
    spindle = hexagon(1.1 * tower, 0.3 * bore, (0, 0, tower_top))  # packing nut
    spindle += rod(stem, 0.95 * bore, (0, 0, tower_top))
    spindle += hexagon(0.75 * bore, 0.35 * bore, (0, 0, low + plate))
    return Assembly({"brass": body, "red paint": handle, "zinc": spindle})


def flat_fan_nozzle(thread: float, pitch: float, flats: float) -> Shape:
    """Spray nozzle along z: a male thread, a hexagon, and a dome slit by a 60 degree wedge.

    The wedge just opens the round end of the bore: that is the orifice.
    """
    screwed, hexagon_height, tip, bore = 10.0, 8.0, 0.72 * flats, 0.5 * thread
    dome = hexagon_height + 0.4 * tip  # level of its center
    bore_end = dome - 0.08 * tip  # center of its round end
    slit = bore_end + 0.42 * bore  # bottom of the wedge
    nozzle = threaded(thread, pitch, screwed, (0, 0, -screwed)) + faced_hexagon(
        flats, hexagon_height
    )
    nozzle += rod(tip, dome) + Pos(0, 0, dome) * Sphere(tip / 2)
    nozzle -= rod(bore, screwed + bore_end, (0, 0, -screwed)) + Pos(0, 0, bore_end) * Sphere(
        bore / 2
    )
    rise = tip / math.tan(math.radians(30))
    return nozzle - upright([(0, slit), (tip, slit + rise), (-tip, slit + rise)], 2 * tip)


RECIPES = [
    Recipe(
        "ball-valve-g1-2",
        "2-piece ball valve DN15 G 1/2",
        "build123d",
        ball_valve,
        {"bore": 15.0, "thread_core": 18.6, "length": 60.0, "lever": 95.0},
    ),
    Recipe(
        "nozzle-flat-fan-r1-4",
        "flat-fan spray nozzle, thread R 1/4",
        "build123d",
        flat_fan_nozzle,
        {"thread": 13.16, "pitch": 1.337, "flats": 17.0},
        finish="brass",
    ),
    *fluid_power.RECIPES,
    *gate_valves.RECIPES,
]
