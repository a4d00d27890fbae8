"""Brackets, clevises and structural parts."""

from build123d import Shape

from industnerf.parts.families.drawing import (
    bar,
    block,
    on_grid,
    rod,
    slot,
    turned,
    upright,
)
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


def motor_mount(pilot: float, bolt_pitch: float, bolt: float, sheet: float) -> Shape:
    """Welded angle for a motor of NEMA ICS 16: face plate in x < 0, foot with slots, two gussets.

    The shaft's axis is along x; the underside of the foot lies at z = 0.
    """
    width, foot, height = 1.75 * bolt_pitch, 1.7 * bolt_pitch, 1.75 * bolt_pitch
    axis_height, gusset = sheet + 0.88 * bolt_pitch, 0.75 * sheet
    mount = block(foot, width, sheet, (foot / 2 - sheet, 0, 0))
    mount += block(sheet, width, height, (-sheet / 2, 0, 0))
    for side in (1, -1):
        triangle = [
            (0, sheet),
            (0.8 * foot, sheet),
            (0.8 * foot, sheet + 4),
            (4, 0.92 * height),
            (0, 0.92 * height),
        ]
        mount += upright(triangle, gusset, side * (width - gusset) / 2)
    mount -= bar(pilot, 4 * sheet, "x", (0, 0, axis_height))
    for y, z in on_grid(bolt_pitch, bolt_pitch):
        mount -= bar(bolt, 4 * sheet, "x", (0, y, axis_height + z))
    slots = [(x, y) for x in (0.3 * foot, 0.72 * foot) for y in (-0.24 * width, 0.24 * width)]
    return mount - [slot(4 * sheet, 6.6, 4 * sheet, (x, y, -sheet)) for x, y in slots]


RECIPES = [
    Recipe(
        "clevis-din71752-g12x24",
        "DIN 71752 G12x24-like",
        "build123d",
        clevis,
        {"pin": 12.0, "slot_length": 24.0, "thread_core": 10.2},
    ),
    Recipe(
        "motor-mount-nema23",
        "NEMA 23 motor mount",
        "build123d",
        motor_mount,
        {"pilot": 38.5, "bolt_pitch": 47.14, "bolt": 5.3, "sheet": 5.0},
    ),
]
