"""Hand tools, tool holders and small hardware."""

import math

from build123d import Circle, Pos, Rot, Shape, Sketch, extrude

from industnerf.parts.families.drawing import (
    block,
    hexagon,
    rod,
    tangent_hull,
    turned,
)
from industnerf.parts.recipe import MeshBoolean, Recipe


def combination_spanner(size: float, length: float) -> Shape:
    """Combination spanner, proportions after DIN 3113 A: jaw at the origin, ring along -x."""
    jaw_head, jaw_thick, jaw_angle = 2.15 * size, 0.47 * size, 15.0
    ring_head, ring_thick = 1.53 * size, 0.62 * size
    shank_thick, recess = 0.34 * size, 0.05 * size
    clearance = 1.012 * size
    ring_x = -(length - jaw_head / 2 - ring_head / 2)

    def plate(sketch: Sketch, thickness: float) -> Shape:
        return extrude(sketch, thickness / 2, both=True)

    near, far = (-0.45 * jaw_head, 0.0), (ring_x + 0.4 * ring_head, 0.0)
    spanner = plate(Circle(jaw_head / 2), jaw_thick)
    spanner += plate(tangent_hull(near, 0.43 * size, far, 0.36 * size), shank_thick)
    spanner += Pos(ring_x, 0, -ring_thick / 2) * rod(ring_head, ring_thick)
    # the nut's seat: two parallel flats that end in half a hexagon
    mouth = hexagon(clearance, 2 * jaw_thick) + block(
        jaw_head, clearance, 2 * jaw_thick, (jaw_head / 2, 0, 0)
    )
    spanner -= Pos(0, 0, -jaw_thick) * Rot(0, 0, jaw_angle) * mouth
    spanner -= [
        Pos(ring_x, 0, -ring_thick) * Rot(0, 0, turn) * hexagon(clearance, 2 * ring_thick)
        for turn in (0, 30)
    ]
    panel = tangent_hull(
        (-0.95 * jaw_head, 0), 0.25 * size, (ring_x + 1.05 * ring_head, 0), 0.2 * size
    )
    for side in (1, -1):
        spanner -= Pos(0, 0, side * shank_thick / 2) * plate(panel, 2 * recess)
    return spanner


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


RECIPES = [
    Recipe(
        "collet-er32-d12",
        "ISO 15488 ER32 d12-like",
        "build123d",
        spring_collet,
        {"bore": 12.0},
    ),
    Recipe(
        "spanner-din3113-17",
        "DIN 3113 A 17-like",
        "build123d",
        combination_spanner,
        {"size": 17.0, "length": 200.0},
    ),
]
