"""Brackets, clevises and structural parts."""

from build123d import Shape

from industnerf.parts.families.drawing import bar, block, rod, turned
from industnerf.parts.recipe import Recipe


def clevis(pin: float, slot_length: float, thread_core: float) -> Shape:
    """Fork head after DIN 71752: a square bar, its ends turned, slotted and cross-drilled.

    The pin's axis lies at the origin along x, the neck points down.
    """
    side, neck, reach = 2 * pin, 5 / 3 * pin, 4 * pin  # reach: from the pin to the neck's face
    tip, neck_length, chamfer = 7 / 6 * pin, 1.5 * pin, pin / 24
    corner = 0.64 * side  # radius to which the square's corners are turned
    fork = block(side, side, reach + tip, (0, 0, -reach)) & turned(
        [
            (0, -reach),
            (neck / 2 - chamfer, -reach),
            (neck / 2, -reach + chamfer),
            (neck / 2, -reach + neck_length),
            (corner, -reach + neck_length + 0.4 * pin),
            (corner, tip - 0.45 * pin),
            (corner - 0.3 * pin, tip),
            (0, tip),
        ]
    )
    fork -= block(pin, 2 * side, slot_length + tip, (0, 0, -slot_length))
    fork -= bar(pin, 2 * side, "x")
    return fork - rod(thread_core, reach - slot_length, (0, 0, -reach))


RECIPES = [
    Recipe(
        "clevis-din71752-g12x24",
        "DIN 71752 G12x24-like",
        "build123d",
        clevis,
        {"pin": 12, "slot_length": 24, "thread_core": 10.2},
    ),
]
