"""Chain and indexing drives."""

import math

from bd_warehouse.sprocket import Sprocket
from build123d import Align, Axis, Pos, Shape, SlotCenterToCenter, chamfer, extrude

from industnerf.parts.catalogue.families.drawing import (
    bar,
    copies_on_circle,
    hub_keyway,
    on_circle,
    rod,
    rods,
    turned,
)
from industnerf.parts.catalogue.recipe import Recipe


def geneva_wheel(distance: float, slots: int, pin: float, thickness: float, bore: float) -> Shape:
    """Driven wheel of an external Geneva drive, its driver at `distance`.

    The crank's pin enters a slot along its axis, so crank and wheel radius meet at a right angle.
    """
    half_step = math.pi / slots
    crank, radius = distance * math.sin(half_step), distance * math.cos(half_step)
    play, hub, edge = 0.2, 2 * bore, 0.6
    locking = crank - 1.5 * pin  # radius of the driver's disc, round which the wheel is hollowed
    deepest = distance - crank  # the pin's nearest place to the wheel's axis
    slot = Pos(2 * deepest, 0) * SlotCenterToCenter(2 * deepest, pin + play)
    wheel = rod(2 * radius, thickness)
    wheel -= copies_on_circle(slots, extrude(slot, thickness))
    wheel -= rods(on_circle(slots, 2 * distance, 180 / slots), 2 * (locking + play), thickness)
    wheel = chamfer(wheel.faces().filter_by(Axis.Z).edges(), edge)
    length = 2 * thickness
    wheel += rod(hub, length)
    return wheel - rod(bore, length) - hub_keyway(bore, 0.3 * bore, 0.15 * bore, length)


def sprocket(
    teeth: int, pitch: float, roller: float, width: float, bore: float, hub: float, length: float
) -> Shape:
    """Chain wheel of ISO 606 with a hub on one side, a keyway of DIN 6885 and a set screw."""
    key, depth, screw = 0.3 * bore, 0.14 * bore, 0.3 * bore
    wheel = Sprocket(
        teeth, pitch, roller, thickness=width, align=(Align.CENTER, Align.CENTER, Align.MIN)
    )
    body = turned([(0, 0), (hub / 2, 0), (hub / 2, length - 1), (hub / 2 - 1, length), (0, length)])
    wheel = wheel + body - rod(bore, length) - hub_keyway(bore, key, depth, length)
    return wheel - bar(screw, hub, "y", (0, hub / 2, (width + length) / 2))


RECIPES = [
    Recipe(
        "geneva-wheel-6-slots",
        "Geneva wheel, 6 slots, centers 80",
        "build123d",
        geneva_wheel,
        {"distance": 80.0, "slots": 6, "pin": 10.0, "thickness": 10.0, "bore": 15.0},
    ),
    Recipe(
        "sprocket-iso606-08b-z19",
        "ISO 606 08B-1 z19-like",
        "bd_warehouse",
        sprocket,
        {
            "teeth": 19,
            "pitch": 12.7,
            "roller": 8.51,
            "width": 7.2,
            "bore": 20.0,
            "hub": 60.0,
            "length": 28.0,
        },
        finish="black oxide",
    ),
]
