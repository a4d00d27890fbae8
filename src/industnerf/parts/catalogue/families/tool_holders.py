"""Tool holders, collets and cutters."""

import math

from build123d import Pos, Rot, Shape, Solid, chamfer

from industnerf.parts.catalogue.families.drawing import (
    block,
    copies_on_circle,
    polygon,
    rod,
    turned,
)
from industnerf.parts.catalogue.recipe import Assembly, MeshBoolean, Recipe


def spring_collet(bore: float) -> MeshBoolean:
    """ER32 collet of ISO 15488 (DIN 6499-B): 8 degree cone, 30 degree head, 16 slots."""
    largest, length, slot_width = 33.0, 40.0, 1.2
    groove_low, groove_high, groove_core = 31.5, 34.7, 29.2
    cone = math.tan(math.radians(8))
    tip = largest / 2 - groove_low * cone
    collet = turned(
        [
            (0, 0),
            (tip - 0.6, 0),
            (tip, 0.8),
            (largest / 2, groove_low),
            (groove_core / 2, groove_low + 0.8),
            (groove_core / 2, groove_high),
            (largest / 2, groove_high + 1.1),
            (largest / 2 - 2.5, length),
            (0, length),
        ]
    )
    blade = block(largest, slot_width, length, (largest / 2, 0, 0))
    from_below = [Rot(0, 0, 45 * i) * Pos(0, 0, -8) * blade for i in range(8)]
    from_above = [Rot(0, 0, 22.5 + 45 * i) * Pos(0, 0, 8) * blade for i in range(8)]
    return MeshBoolean(join=[collet], cut=[rod(bore, length), *from_below, *from_above])


def collet_chuck(gauge: float, taper: float, flange: float, reach: float, bore: float) -> Assembly:
    """BT tool holder (MAS 403): 7/24 taper from the gauge plane z = 0 down, ER32 chuck above.

    `gauge` is the taper's diameter there, `taper` its length, `reach` the height of the nut.
    """
    thick, drive = 27.0, 16.1  # the flange's front face; width of its drive slots
    groove_middle, groove_core = 16.6, 0.84 * flange
    tail = gauge / 2 - taper * 7 / 48  # radius of the taper's small end
    cheek = (flange - groove_core) / 2 * math.tan(math.radians(30))
    nose, nut, nut_height = 42.0, 50.0, 22.0
    low, high = groove_middle - 2 - cheek, groove_middle + 2 + cheek
    holder = turned(
        [
            (0, -taper),
            (tail - 1, -taper),
            (tail, 1 - taper),
            (gauge / 2, 0),
            (gauge / 2 - 1, 2),
            (flange / 2, 2),
            (flange / 2, low),
            (groove_core / 2, groove_middle - 2),
            (groove_core / 2, groove_middle + 2),
            (flange / 2, high),
            (flange / 2, thick),
            (nose / 2 + 3, thick),
            (nose / 2, thick + 3),
            (nose / 2, reach - 4),
            (0, reach - 4),
        ]
    )
    drive_radius = 22.6  # from the axis to the floor of the drive slots
    for side in (1, -1):
        holder -= block(gauge, drive, thick - 2, (side * (drive_radius + gauge / 2), 0, 2))
    holder -= rod(13.8, 34.0, (0, 0, -taper))  # M16 for the pull stud
    holder -= rod(bore, reach, (0, 0, 0.3 * reach))
    cap = chamfer(rod(nut, nut_height, (0, 0, reach - nut_height)).edges(), 1.5)
    spanner_slot = block(6.0, 6.0, nut_height, (nut / 2, 0, reach - nut_height + 4))
    cap = cap - rod(29.0, reach) - copies_on_circle(6, spanner_slot)
    collet = spring_collet(bore)
    raised = Pos(0, 0, reach - 41)
    return Assembly(
        {
            "steel": holder,
            "black oxide": cap,
            "bright steel": MeshBoolean(
                [raised * body for body in collet.join], [raised * body for body in collet.cut]
            ),
        }
    )


def end_mill(diameter: float, fluted: float, length: float) -> Shape:
    """Four-flute end mill, helix 30 degrees, cutting end on z = 0; cylindrical shank."""
    radius = diameter / 2
    # one tooth: its edge, land, flute and rake face, in shares of the radius and degrees
    tooth = [(1, 0), (0.97, 12), (0.86, 30), (0.68, 48), (0.59, 62), (0.62, 74), (0.8, 84)]
    outline = [
        (
            radius * r * math.cos(math.radians(a + turn)),
            radius * r * math.sin(math.radians(a + turn)),
        )
        for turn in (0, 90, 180, 270)
        for r, a in tooth
    ]
    twist = math.degrees(fluted * math.tan(math.radians(30)) / radius)
    flutes = Solid.extrude_linear_with_rotation(
        polygon(outline).face(), (0, 0, 0), (0, 0, fluted), twist
    )
    run_out = fluted - 0.6 * diameter
    shank = turned(
        [
            (0, run_out),
            (0.55 * radius, run_out),
            (radius, fluted - 0.05 * diameter),
            (radius, length - 0.5),
            (radius - 0.5, length),
            (0, length),
        ]
    )
    gash = block(
        radius, 0.14 * diameter, 0.16 * diameter, (0.5 * radius, -0.1 * diameter, -0.05 * diameter)
    )
    return flutes + shank - copies_on_circle(4, gash)


RECIPES = [
    Recipe(
        "collet-chuck-bt40-er32-70",
        "MAS 403 BT40 collet chuck ER32-70-like",
        "build123d",
        collet_chuck,
        {"gauge": 44.45, "taper": 65.4, "flange": 63.0, "reach": 70.0, "bore": 12.0},
    ),
    Recipe(
        "collet-er32-d12",
        "ISO 15488 ER32 d12-like",
        "build123d",
        spring_collet,
        {"bore": 12.0},
        finish="bright steel",
    ),
    Recipe(
        "end-mill-d10",
        "ISO 1641-1 end mill D10x22x72-like, 4 flutes",
        "build123d",
        end_mill,
        {"diameter": 10.0, "fluted": 22.0, "length": 72.0},
        finish="bright steel",
    ),
]
