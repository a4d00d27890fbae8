"""Rings, knobs, and what holds and connects cables."""

from bd_warehouse.retaining_ring import ExternalSnapRing
from build123d import Circle, Ellipse, Plane, Pos, Rot, Shape, extrude, loft

from industnerf.parts.catalogue.families.drawing import (
    Point,
    bent_sheet,
    faced_hexagon,
    hexagon,
    on_circle,
    rod,
    rods,
    slot,
    tangent_hull,
    threaded,
    turned,
)
from industnerf.parts.catalogue.recipe import Assembly, Recipe


def retaining_ring(shaft: str) -> Shape:
    """External retaining ring of DIN 471 for a shaft of that many mm."""
    return ExternalSnapRing(shaft)


def cable_gland(thread: float, pitch: float, flats: float, cable: float) -> Assembly:
    """Cable gland along z: thread with its lock nut below the collar, domed nut, rubber seal."""
    screwed, collar, neck, dome = 12.0, 6.0, 3.0, 17.0
    base, corner = collar + neck, 1.155 * flats / 2
    passage = rod(cable + 3, 2 * dome + 4, (0, 0, -screwed))
    body = threaded(thread, pitch, screwed, (0, 0, -screwed)) + faced_hexagon(flats, collar)
    body += rod(0.88 * flats, neck, (0, 0, collar)) + faced_hexagon(flats, 4.5, (0, 0, -9.0))
    cap = hexagon(flats, dome) & turned(
        [
            (0, 0),
            (0.48 * flats, 0),
            (corner, 1.4),
            (corner, 0.5 * dome),
            (0.46 * flats, 0.75 * dome),
            (0.36 * flats, dome),
            (0, dome),
        ]
    )
    seal = rod(0.62 * flats, dome - 4, (0, 0, base + 3)) + rod(0.56 * flats, dome, (0, 0, base + 1))
    seal -= rod(cable, 2 * dome, (0, 0, base))
    shell = body + Pos(0, 0, base) * cap - passage - rod(0.57 * flats, dome, (0, 0, base + 2))
    return Assembly({"brass": shell, "rubber": seal})


def mounting_rail(width: float, height: float, hat: float, sheet: float, slots: int) -> Shape:
    """Top-hat rail of EN 60715, along y, its back on z = 0; slots 15 x 6.2 every 25 mm."""
    pitch, inner_bend = 25.0, 0.8
    half, wall, lip = width / 2, (hat - sheet) / 2, height - sheet / 2
    back = sheet / 2
    path = [(-half, lip), (-wall, lip), (-wall, back), (wall, back), (wall, lip), (half, lip)]
    rail = bent_sheet(path, sheet, inner_bend + sheet / 2, slots * pitch)
    middles = [(i - (slots - 1) / 2) * pitch for i in range(slots)]
    return rail - [Rot(0, 0, 90) * slot(15.0, 6.2, 3 * sheet, (y, 0, -sheet)) for y in middles]


def cable_lug(barrel: float, bore: float, palm: float, bolt: float, length: float) -> Shape:
    """Compression cable lug after DIN 46235: barrel along -x, palm along +x, both on z = 0.

    The bolt's axis passes through the origin.
    """
    thick, barrel_length, taper = 0.36 * barrel, 0.5 * length, 0.14 * length
    start = -(length - barrel_length - palm / 2)  # where barrel and taper meet
    lug = extrude(tangent_hull((0, 0), palm / 2, (start + taper, 0), 0.42 * palm), thick)
    across = Plane((start, 0, barrel / 2), x_dir=(0, 1, 0), z_dir=(1, 0, 0))
    flat = Plane((start + taper, 0, thick / 2), x_dir=(0, 1, 0), z_dir=(1, 0, 0))
    lug += loft([across * Circle(barrel / 2), flat * Ellipse(0.42 * palm, thick / 2)])
    lug += extrude(across * Circle(barrel / 2), -barrel_length)
    lug -= extrude(across * Circle(bore / 2), -barrel_length)
    lug -= rod(2.0, barrel, (start - 2, 0, barrel / 2))  # to see the cable's end
    return lug - rod(bolt, thick)


def star_knob(diameter: float, hub: float, height: float, thread: float, lobes: int) -> Assembly:
    """Star knob after DIN 6336 along z, the hub below, a brass bush with thread molded in."""
    head, bush = 0.62 * height, 1.7 * thread
    scallops = rods(on_circle(lobes, 1.1 * diameter), 0.28 * diameter, height)
    knob = turned(_knob_outline(diameter, hub, height, head)) - scallops
    brass = rod(bush, 0.7 * height, (0, 0, -0.5))  # proud of the hub
    brass -= threaded(thread, 1.5, 0.6 * height, (0, 0, -0.5))
    return Assembly({"black plastic": knob - rod(bush - 0.2, 0.68 * height), "brass": brass})


def _knob_outline(diameter: float, hub: float, height: float, head: float) -> list[Point]:
    """(radius, z) of the hub, the underside of the head, its rounded rim and domed top."""
    low, rim = height - head, 0.14 * head
    return [
        (0, 0),
        (hub / 2 - 0.5, 0),
        (hub / 2, 0.5),
        (hub / 2 + 1, low),
        (diameter / 2 - rim, low + 0.5),
        (diameter / 2, low + 0.5 + rim),
        (diameter / 2, height - 3 * rim),
        (diameter / 2 - rim, height - 1.8 * rim),
        (diameter / 2 - 3 * rim, height - 0.7 * rim),
        (0.2 * diameter, height),
        (0, height),
    ]


RECIPES = [
    Recipe(
        "cable-gland-m20",
        "cable gland M20x1.5 for cable 10",
        "build123d",
        cable_gland,
        {"thread": 20.0, "pitch": 1.5, "flats": 24.0, "cable": 10.0},
    ),
    Recipe(
        "cable-lug-din46235-25-m10",
        "DIN 46235 cable lug 25 mm2 M10-like",
        "build123d",
        cable_lug,
        {"barrel": 10.0, "bore": 7.0, "palm": 19.0, "bolt": 10.5, "length": 52.0},
        finish="copper",
    ),
    Recipe(
        "mounting-rail-en60715-th35",
        "EN 60715 TH 35-7.5, slotted, length 150",
        "build123d",
        mounting_rail,
        {"width": 35.0, "height": 7.5, "hat": 27.0, "sheet": 1.0, "slots": 6},
        finish="zinc",
    ),
    Recipe(
        "retaining-ring-din471-30",
        "DIN 471 30x1.5",
        "bd_warehouse",
        retaining_ring,
        {"shaft": "30"},
        finish="black oxide",
    ),
    Recipe(
        "star-knob-din6336-50-m10",
        "DIN 6336 50 M10-like",
        "build123d",
        star_knob,
        {"diameter": 50.0, "hub": 25.0, "height": 32.0, "thread": 10.0, "lobes": 7},
    ),
]
