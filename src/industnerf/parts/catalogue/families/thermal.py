"""Heat sinks and heat exchangers."""

import math

from build123d import Align, Circle, Pos, Rectangle, Rot, Shape, extrude

from industnerf.parts.catalogue.families.drawing import (
    Point,
    block,
    copies_on_circle,
    on_circle,
    on_grid,
    rod,
    rods,
)
from industnerf.parts.catalogue.recipe import Assembly, MeshBoolean, Recipe


def plate_fin_sink(
    width: float, length: float, height: float, base: float, fins: int, fin: float
) -> Shape:
    """Extruded heat sink, fins along y, with four mounting holes between the fins."""
    pitch = (width - fin) / (fins - 1)
    sink = block(width, length, base)
    sink += [
        block(fin, length, height - 0.5 * base, ((i - (fins - 1) / 2) * pitch, 0, 0.5 * base))
        for i in range(fins)
    ]
    holes = on_grid((fins - 4) * pitch, 0.75 * length)
    return sink - rods(holes, 3.4, base)


def pin_fin_sink(side: float, height: float, base: float, pins: int, pin: float) -> Shape:
    """Forged heat sink, `pins` by `pins` round pins, a screw hole in place of each corner's."""
    pitch = (side - 1.3 * pin) / (pins - 1)
    corner = (pins - 1) * pitch / 2
    rows = [i * pitch - corner for i in range(pins)]
    standing = [(x, y) for x in rows for y in rows if min(abs(x), abs(y)) < corner - 0.1]
    sink = block(side, side, base) + rods(standing, pin, height - 0.5 * base, 0.5 * base)
    return sink - rods(on_grid(2 * corner, 2 * corner), 3.4, base)


def radial_sink(diameter: float, height: float, core: float, fins: int, fin: float) -> Shape:
    """Extruded star for a round lamp: the fins fork; a bore and three screw holes in the core."""
    fork, half_angle = 0.31 * diameter, 16.5  # where the fins fork, and by how many degrees
    from_left = (Align.MIN, Align.CENTER)
    prong = Rectangle(0.22 * diameter, 0.8 * fin, align=from_left)
    prongs = [Pos(fork - 0.4 * fin, 0) * Rot(0, 0, s * half_angle) * prong for s in (1, -1)]
    star = Circle(core / 2) + copies_on_circle(fins, Rectangle(fork, fin, align=from_left) + prongs)
    sink = extrude(star & Circle(diameter / 2), height)
    sink -= rod(0.3 * core, height)
    return sink - rods(on_circle(3, 0.64 * core, 30), 3.3, height)


def tube_bundle(shell: float, length: float, tube: float, pitch: float, baffles: int) -> Assembly:
    """Straight tubes in two tube sheets, held by segmental baffles and four tie rods, TEMA-like.

    The fixed sheet on z = 0 is as wide as the shell's flange and bored for its bolts.
    """
    bore, fixed_sheet, floating, plate = 0.8 * tube, 14.0, 12.0, 3.0
    flange, bolt_circle, inside = 1.42 * shell, 1.22 * shell, shell - 2.0
    tubes = _triangular_pattern(pitch, 0.4 * shell)
    gap = (length - fixed_sheet - floating) / (baffles + 1)
    levels = [fixed_sheet + (i + 1) * gap for i in range(baffles)]

    sheets = rod(flange, fixed_sheet) + rod(inside, floating, (0, 0, length - floating))
    sheets -= rods(on_circle(8, bolt_circle, 22.5), 9.0, fixed_sheet)
    segment = rod(inside, plate) - block(0.5 * shell, shell, plate, (0.52 * shell, 0, 0))
    baffled = [Pos(0, 0, z) * Rot(0, 0, 180 * (i % 2)) * segment for i, z in enumerate(levels)]
    tie_length = levels[-1] + 8 - 0.5 * fixed_sheet
    ties = rods(on_grid(0.1 * shell, 0.88 * shell), 4.0, tie_length, 0.5 * fixed_sheet)
    seats = rods(tubes, (bore + tube) / 2, length + 2, -1)  # the tubes are rolled into them
    bores = rods(tubes, bore, length + 4, -2)
    return Assembly(
        {
            "steel": MeshBoolean([sheets], seats),
            "copper": MeshBoolean(rods(tubes, tube, length + 1, -0.5), bores),
            "brass": MeshBoolean(baffled, seats),
            "zinc": MeshBoolean(ties, []),
        }
    )


def _triangular_pattern(pitch: float, within: float) -> list[Point]:
    """Points of a triangular pattern about a point of it, as far as `within`."""
    reach = range(-int(2 * within / pitch), int(2 * within / pitch) + 1)
    rise = math.sqrt(3) / 2
    points = [((i + j / 2) * pitch, j * rise * pitch) for i in reach for j in reach]
    return [point for point in points if math.hypot(*point) < within]


RECIPES = [
    Recipe(
        "heat-sink-pin-fin-60x60",
        "forged pin-fin heat sink 60x60x30, 8x8 pins",
        "build123d",
        pin_fin_sink,
        {"side": 60.0, "height": 30.0, "base": 5.0, "pins": 8, "pin": 4.0},
        finish="copper",
    ),
    Recipe(
        "heat-sink-plate-fin-80x60",
        "extruded heat sink 80x60x36, 16 fins",
        "build123d",
        plate_fin_sink,
        {"width": 80.0, "length": 60.0, "height": 36.0, "base": 6.0, "fins": 16, "fin": 1.6},
        finish="aluminum",
    ),
    Recipe(
        "heat-sink-radial-d90",
        "extruded radial heat sink D90x40, 18 forked fins",
        "build123d",
        radial_sink,
        {"diameter": 90.0, "height": 40.0, "core": 34.0, "fins": 18, "fin": 2.0},
        finish="black oxide",
    ),
    Recipe(
        "tube-bundle-d90",
        "straight tube bundle D90x220, tubes 14x1.4, 3 baffles",
        "build123d",
        tube_bundle,
        {"shell": 90.0, "length": 220.0, "tube": 14.0, "pitch": 19.0, "baffles": 3},
    ),
]
