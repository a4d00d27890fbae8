"""The block of a four-cylinder engine.

The crankshaft's axis is that of y at z = 0; the cylinders stand on it along z.
"""

from build123d import Shape

from industnerf.parts.catalogue.families.drawing import (
    Point,
    Real,
    bar,
    block,
    faced_hexagon,
    fused,
    rods,
    tube,
    upright,
)
from industnerf.parts.catalogue.recipe import Assembly, Recipe

CYLINDERS = 4
CAST_WALL = 9.0


def along(count: int, pitch: Real) -> list[Real]:
    """`count` stations at `pitch`, centered on zero."""
    return [(i - (count - 1) / 2) * pitch for i in range(count)]


def outline(bore: Real, outset: Real, low: Real, high: Real) -> list[Point]:
    """The block over (x, z): a wide skirt, a slope, the narrow walls of the cylinders."""
    skirt, wall = 1.1 * bore + outset, 0.8 * bore + outset
    side = [(skirt, low), (skirt, 0.3 * bore), (wall, 0.9 * bore), (wall, high)]
    return side + [(-x, z) for x, z in reversed(side)]


def casting(bore: Real, pitch: Real, deck: Real) -> list[Shape]:
    """Everything that stands before a tool touches it: walls, ribs, sump rail, bell flange."""
    low, length = -0.6 * bore, CYLINDERS * pitch + 0.4 * bore
    ribs = along(CYLINDERS + 1, pitch)
    bell = outline(bore, 17, 0.85 * low, 0.55 * deck)
    return [
        upright(outline(bore, 0, low, deck), length),
        upright(bell, 12, length / 2 - 6),
        block(2.5 * bore, length, 12, (0, 0, low)),
        *[upright(outline(bore, 5, 0.9 * low, 0.8 * deck), 7, y) for y in ribs],
        *[bar(0.5 * bore, 1.6 * bore + 8, "x", (0, y, 0.72 * deck)) for y in along(4, pitch)],
        bar(0.8 * bore, 0.4 * bore, "x", (-bore, -pitch, 0)),  # the oil filter's pad
    ]


def oil_space(bore: Real, pitch: Real, deck: Real, main: Real) -> list[Shape]:
    """What the crank turns in: a bay below each cylinder, bulkheads between, the bearings' bore."""
    low, length = -0.6 * bore, CYLINDERS * pitch + 0.4 * bore
    inside = outline(bore, -CAST_WALL, low - 1, 0.42 * deck)
    bays = [upright(inside, 0.8 * pitch, y) for y in along(CYLINDERS, pitch)]
    below = 2.2 * bore - 2 * CAST_WALL
    space_of_caps = block(below, length - 2 * CAST_WALL, 1 - low, (0, 0, low - 1))
    return [*bays, space_of_caps, bar(main, 2 * length, "y")]


def water_space(bore: Real, pitch: Real, deck: Real) -> list[Shape]:
    """Jackets round the cylinders, open at the deck; the cylinders' own walls touch."""
    depth, floor = 0.45 * deck, 0.55 * deck
    centers = [(0, y) for y in along(CYLINDERS, pitch)]
    walls = rods(centers, bore + 11, depth + 2, floor - 1)
    return [well - walls for well in rods(centers, bore + 23, depth + 1, floor)]


def drillings(bore: Real, pitch: Real, deck: Real) -> list[Shape]:
    """Cylinders, head bolts, sump bolts, bell bolts, seats of the core plugs."""
    low, length = -0.6 * bore, CYLINDERS * pitch + 0.4 * bore
    head = [(s * 0.68 * bore, y) for y in along(5, pitch) for s in (1, -1)]
    sump = [(s * 1.18 * bore, y) for y in along(6, 0.19 * length) for s in (1, -1)]
    bell = [(s * x, z) for x, z in ((101, -30), (101, 12), (76, 100)) for s in (1, -1)]
    tools = rods([(0, y) for y in along(CYLINDERS, pitch)], bore + 1, deck, 0.3 * deck)
    tools += rods(head, 11, 0.4 * deck, 0.7 * deck) + rods(sump, 7, 20, low - 1)
    tools += [bar(10, 40, "y", (x, length / 2, z)) for x, z in bell]
    seat = 0.8 * bore + 4
    for y in along(CYLINDERS, pitch):
        tools += [bar(0.36 * bore, 8, "x", (s * seat, y, 0.72 * deck)) for s in (1, -1)]
    return tools


def cylinder_block(bore: Real, pitch: Real, deck: Real, main: Real) -> Assembly:
    """Open-deck light alloy block with iron liners; the main bearings' caps are bolted on.

    `deck` is the height of the upper face over the crankshaft, `main` its journals' diameter.
    """
    cylinders, bulkheads = along(CYLINDERS, pitch), along(CYLINDERS + 1, pitch)
    liners = [tube(bore + 5, bore, 0.62 * deck, (0, y, 0.38 * deck)) for y in cylinders]
    drop, across = 0.8 * main, 0.85 * main
    caps = [block(2.5 * main, 0.2 * pitch, drop + 1, (0, y, -drop)) for y in bulkheads]
    bolts = [
        faced_hexagon(16, 10.5, (s * across, y, -drop - 10)) for y in bulkheads for s in (1, -1)
    ]
    seat = 0.8 * bore + 0.5
    plugs = [
        bar(0.37 * bore, 3, "x", (s * seat, y, 0.72 * deck)) for y in cylinders for s in (1, -1)
    ]
    stub = bar(20, 40, "x", (-1.2 * bore, -pitch, 0))  # the oil filter's thread
    tools = [
        *oil_space(bore, pitch, deck, main),
        *water_space(bore, pitch, deck),
        *drillings(bore, pitch, deck),
    ]
    shaft = bar(main, CYLINDERS * 2 * pitch, "y")
    return Assembly(
        {
            "aluminum": fused(casting(bore, pitch, deck)) - tools,
            "cast iron": fused([*liners, *caps]) - shaft,
            "black oxide": fused(bolts),
            "zinc": fused([*plugs, stub]),
        }
    )


RECIPES = [
    Recipe(
        "cylinder-block-4-d84",
        "four-cylinder open-deck block, bore 84, pitch 92",
        "build123d",
        cylinder_block,
        {"bore": 84.0, "pitch": 92.0, "deck": 210.0, "main": 54.0},
    ),
]
