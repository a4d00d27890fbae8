"""Brackets, clevises and eye bolts; profiles and plates are in `structures`."""

from build123d import Axis, Pos, Rot, Shape, Torus, fillet

from industnerf.parts.catalogue.families import structures
from industnerf.parts.catalogue.families.drawing import (
    bar,
    bent_sheet,
    block,
    on_grid,
    rod,
    rods,
    slot,
    threaded,
    turned,
    upright,
)
from industnerf.parts.catalogue.recipe import MeshBoolean, Recipe


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


def gusseted_angle(leg: float, width: float, wall: float, bolt: float) -> Shape:
    """Die-cast angle for framing: two equal legs, a gusset along each side, slots and bores.

    The outer corner lies at the origin along y, the legs point along +x and +z.
    """
    gusset, corner, nose = 0.7 * wall, 8.0, 0.16 * leg
    legs = [(0, 0), (leg, 0), (leg, wall), (wall, wall), (wall, leg), (0, leg)]
    angle = upright(legs, width)
    ends = angle.edges().filter_by(Axis.Z).group_by(Axis.X)[-1]
    ends += angle.edges().filter_by(Axis.X).group_by(Axis.Z)[-1]
    angle = fillet(ends, corner)
    brace = [(0, 0), (0.94 * leg, 0), (0.94 * leg, nose), (nose, 0.94 * leg), (0, 0.94 * leg)]
    for side in (1, -1):
        angle += upright(brace, gusset, side * (width / 2 - gusset))
    inner = angle.edges().filter_by(Axis.Y).sort_by_distance((wall, 0, wall))[0]
    angle = fillet(inner, 0.6 * wall)
    angle -= slot(0.36 * leg, bolt, 2 * wall, (0.6 * leg, 0, -wall / 2))
    return angle - [bar(bolt, 3 * wall, "x", (0, 0, z * leg)) for z in (0.42, 0.76)]


def u_bracket(span: float, height: float, width: float, sheet: float, pin: float) -> Shape:
    """Bent sheet-steel fork with round ears; the pin's axis is along x, the base on z = 0."""
    ear = width / 2
    reach, low = (span - sheet) / 2, sheet / 2
    path = [(-reach, height), (-reach, low), (reach, low), (reach, height)]
    fork = bent_sheet(path, sheet, 1.5 * sheet, width)
    pin_height = height - ear
    fork &= bar(width, 2 * span, "x", (0, 0, pin_height)) + block(2 * span, width, pin_height)
    fork -= bar(pin, 2 * span, "x", (0, 0, pin_height))
    fork -= rods(on_grid(0.42 * span, 0.5 * width), 6.6, sheet)
    return fork - rod(0.3 * width, sheet)


def eye_bolt(thread: float, pitch: float, length: float, collar: float, eye: float) -> MeshBoolean:
    """Lifting eye bolt, DIN 580: `eye` is the ring's inside, the seat lies at z = 0.

    United as meshes: OpenCASCADE is not to be trusted with tori.
    """
    ring, eye_top = 0.4 * eye, 62 / 35 * eye
    center = eye_top - eye / 2 - ring
    undercut, seat = 0.4 * pitch, 6.0
    shank = threaded(thread, pitch, length - 0.3 * thread, (0, 0, -length))
    shank += rod(thread - 2 * undercut, 0.4 * thread, (0, 0, -0.4 * thread))
    neck = turned(
        [
            (0, 0),
            (collar / 2 - 1, 0),
            (collar / 2, 1),
            (collar / 2, seat),
            (0.75 * ring, center - eye / 2 - 0.5 * ring),
            (0, center - eye / 2 - 0.5 * ring),
        ]
    )
    torus = Pos(0, 0, center) * Rot(90, 0, 0) * Torus((eye + ring) / 2, ring / 2)
    return MeshBoolean(join=[shank, neck, torus], cut=[])


RECIPES = [
    Recipe(
        "angle-gusseted-80x60",
        "gusseted angle 80x80x60, slot and bores for M8",
        "build123d",
        gusseted_angle,
        {"leg": 80.0, "width": 60.0, "wall": 8.0, "bolt": 8.4},
        finish="aluminum",
    ),
    Recipe(
        "clevis-din71752-g12x24",
        "DIN 71752 G12x24-like",
        "build123d",
        clevis,
        {"pin": 12.0, "slot_length": 24.0, "thread_core": 10.2},
        finish="zinc",
    ),
    Recipe(
        "eye-bolt-din580-m16",
        "DIN 580 M16-like",
        "build123d",
        eye_bolt,
        {"thread": 16.0, "pitch": 2.0, "length": 27.0, "collar": 35.0, "eye": 35.0},
        finish="zinc",
    ),
    Recipe(
        "motor-mount-nema23",
        "NEMA 23 motor mount",
        "build123d",
        motor_mount,
        {"pilot": 38.5, "bolt_pitch": 47.14, "bolt": 5.3, "sheet": 5.0},
        finish="black oxide",
    ),
    Recipe(
        "u-bracket-80x70x50",
        "U bracket 80x70x50, sheet 5, pin 16",
        "build123d",
        u_bracket,
        {"span": 80.0, "height": 70.0, "width": 50.0, "sheet": 5.0, "pin": 16.0},
        finish="yellow paint",
    ),
    *structures.RECIPES,
]
