"""Electric motors and their end shields."""

from bd_warehouse.open_builds import StepperMotor
from build123d import Axis, Circle, Compound, Pos, Rectangle, Rot, Shape, chamfer, extrude, fillet

from industnerf.parts.catalogue.families.drawing import (
    bar,
    block,
    copies_on_circle,
    on_circle,
    on_grid,
    rod,
    rods,
    rounded_block,
    slot,
    turned,
)
from industnerf.parts.catalogue.recipe import Assembly, MeshBoolean, Recipe


def end_shield(frame: float, height: float, bearing: float) -> Shape:
    """Die-cast end bell of a motor: bearing seat, spokes with windows between, four lugs.

    The outer face lies on z = 0, the rim that fits the frame points up.
    """
    wall, hub, spokes, lug, bolt = 6.0, 1.5 * bearing, 8, 18.0, 6.5
    bell = turned(
        [
            (0, 0),
            (0.5 * hub, 0),
            (0.56 * hub, 0.2 * height),
            (0.46 * frame, 0.42 * height),
            (0.5 * frame, 0.5 * height),
            (0.5 * frame, height - 4),
            (0.485 * frame, height - 4),
            (0.485 * frame, height),
            (0.455 * frame, height),
            (0.455 * frame, 0.42 * height + wall),
            (0.56 * hub, 0.2 * height + wall),
            (0.5 * hub, 0.6 * height),
            (0, 0.6 * height),
        ]
    )
    windows = rod(0.84 * frame, height) - rod(1.4 * hub, height)
    windows -= copies_on_circle(spokes, block(frame, 0.13 * frame, height, (0.5 * frame, 0, 0)))
    bell -= windows
    bell += rods(on_circle(4, frame, 22.5), lug, 0.5 * height, 0.5 * height - 4)
    bell -= rods(on_circle(4, 1.03 * frame, 22.5), bolt, height)
    seat = 0.42 * height  # depth of the bearing's seat, from inside
    return bell - rod(bearing, seat, (0, 0, 0.6 * height - seat)) - rod(0.55 * bearing, height)


def foot_motor(
    height: float, across: float, along: float, to_foot: float, shaft: float, reach: float
) -> Assembly:
    """Fan-cooled induction motor on feet (IM B3), its axis along x, the shaft's shoulder at x = 0.

    By the letters of IEC 60072-1: `height` H, `across` A, `along` B, `to_foot` C, `shaft` D,
    `reach` E.
    """
    outside, shield, base = 1.94 * height, 0.25 * height, 0.14 * height
    frame = along + 2 * (to_foot - shield) - 10
    rear = -shield - frame  # where the frame ends and the fan's cowl begins
    middle = -to_foot - along / 2
    box, box_top = 0.95 * height, 1.17 * height  # of the terminals
    gland_level = 0.96 * height

    star = Circle(0.81 * height) + copies_on_circle(20, Rectangle(outside, 3.0), 4.5)  # 40 fins
    body = [
        Pos(rear, 0, 0) * Rot(0, 90, 0) * extrude(star, frame),
        _drive_shield(height, shield),
        bar(outside, 8.0, "x", (rear + 4, 0, 0)),
        rounded_block(box, box, box_top - 0.75 * height, 8.0, (middle, 0, 0.75 * height)),
        bar(26.0, 8.0, "y", (middle, -box / 2, gland_level)),
    ]
    for side in (1, -1):
        pad, leg = (middle, side * across / 2, -height), (middle, side * 0.42 * across, -height)
        body += [rounded_block(along + 26, 0.36 * height, base, 6.0, pad)]
        body += [block(0.8 * along, 0.16 * height, 0.8 * height, leg)]
    anchors = [(middle + x, y, -height - 1) for x, y in on_grid(along, across)]
    lid = rounded_block(box + 4, box + 4, 0.1 * height, 9.0, (middle, 0, box_top))
    gland = bar(18.0, 8.0, "y", (middle, -box / 2 - 4, gland_level))
    return Assembly(
        {
            "blue paint": MeshBoolean(body, [slot(14.0, 10.0, base + 2, at) for at in anchors]),
            "black plastic": _fan_cowl(0.98 * outside, 0.75 * height, rear) + lid + gland,
            "bright steel": _shaft_end(shaft, reach),
        }
    )


def _drive_shield(height: float, depth: float) -> Shape:
    """The end shield that the shaft comes out of, from x = -1 backwards."""
    outline = [
        (0, -1),
        (0.3 * height, -1),
        (0.36 * height, -0.1 * height),
        (0.9 * height, -0.8 * depth),
        (0.96 * height, -depth),
        (0.96 * height, -depth - 8),
        (0, -depth - 8),
    ]
    return Rot(0, 90, 0) * turned(outline)


def _fan_cowl(diameter: float, length: float, front: float) -> Shape:
    """The cowl over the fan, from x = `front` backwards, with radial air slots in its end."""
    slot_depth = 10.0
    cowl = bar(diameter, length + 4, "x", (front - length / 2 + 2, 0, 0))
    cowl = fillet(cowl.edges().sort_by(Axis.X)[0], 10.0)
    air = slot(0.3 * diameter, 4.0, slot_depth, (0.26 * diameter, 0, 0))
    return cowl - Pos(front - length, 0, 0) * Rot(0, 90, 0) * Compound(copies_on_circle(24, air))


def _shaft_end(diameter: float, reach: float) -> Shape:
    """Cylindrical shaft end of IEC 60072-1, with its keyway, rooted in the motor."""
    root, key, depth = 30.0, 0.31 * diameter, 0.18 * diameter
    end = bar(diameter, reach + root, "x", ((reach - root) / 2, 0, 0))
    end = chamfer(end.edges().sort_by(Axis.X)[-1], 1.0)
    return end - slot(0.8 * reach, key, diameter, (0.5 * reach, 0, diameter / 2 - depth))


def stepper_motor(size: str, length: float) -> Assembly:
    """Stepper motor as OpenBuilds sells it, its face on z = 0: laminations between cast ends."""
    motor, shaft = StepperMotor(size, length).children
    end = 11.0  # bd_warehouse's length of the cast ends
    stack = motor & block(60, 60, length - 2 * end, (0, 0, end - length))
    return Assembly({"aluminum": motor - stack, "black oxide": stack, "bright steel": shaft})


RECIPES = [
    Recipe(
        "end-shield-d140",
        "ventilated motor end shield D140, bearing 35",
        "build123d",
        end_shield,
        {"frame": 140.0, "height": 46.0, "bearing": 35.0},
        finish="aluminum",
    ),
    Recipe(
        "motor-iec80-b3",
        "IEC 60072-1 80 IM B3-like",
        "build123d",
        foot_motor,
        {
            "height": 80.0,
            "across": 125.0,
            "along": 100.0,
            "to_foot": 50.0,
            "shaft": 19.0,
            "reach": 40.0,
        },
    ),
    Recipe(
        "motor-stepper-nema23",
        "NEMA 23 stepper motor, length 56",
        "bd_warehouse",
        stepper_motor,
        {"size": "Nema23", "length": 56.0},
    ),
]
