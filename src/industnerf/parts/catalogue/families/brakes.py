"""Brake discs."""

from industnerf.parts.catalogue.families.drawing import (
    Real,
    block,
    copies_on_circle,
    fused,
    on_circle,
    rods,
    tube,
    turned,
)
from industnerf.parts.catalogue.recipe import Assembly, Recipe


def brake_disc(diameter: Real, hat: Real, height: Real, bolts: int, vanes: int) -> Assembly:
    """Ventilated, cross-drilled brake disc: two rings with vanes between, a hat with its bolts."""
    thick, plate, inner = 0.09 * diameter, 0.03 * diameter, 1.12 * hat
    rings = [tube(diameter, inner, plate, (0, 0, z)) for z in (0, thick - plate)]
    length = 0.49 * (diameter - inner)
    vane = block(length, 0.018 * diameter, thick - 2, ((diameter + inner) / 4, 0, 1))
    drills = []
    for row in range(3):  # three rows that wind outwards, always between two vanes
        row_diameter = inner + (0.25 + 0.25 * row) * (diameter - inner)
        start = (row + 0.5) * 360 / vanes
        drills += rods(on_circle(vanes // 3, row_diameter, start), 0.022 * diameter, thick)
    wall, top = 0.03 * diameter, height
    bell = turned(
        [
            (0.24 * hat, top),
            (0.24 * hat, top - wall),
            (0.5 * hat - wall, top - wall),
            (0.5 * hat - wall, 1),
            (0.58 * hat, 1),
            (0.58 * hat, plate - 1),  # let into the lower ring
            (0.55 * hat, plate + 1),
            (0.5 * hat, 1.5 * plate),
            (0.5 * hat, top - 2),
            (0.5 * hat - 2, top),
        ]
    )
    bell -= rods(on_circle(bolts, 0.72 * hat), 0.045 * diameter, wall, top - wall)
    return Assembly(
        {
            "bright steel": fused([*rings, *copies_on_circle(vanes, vane)]) - drills,
            "cast iron": bell,
        }
    )


RECIPES = [
    Recipe(
        "brake-disc-d280",
        "ventilated brake disc D280x25, five bolts",
        "build123d",
        brake_disc,
        {"diameter": 280.0, "hat": 155.0, "height": 52.0, "bolts": 5, "vanes": 30},
    )
]
