"""Wheels, pulleys and hand wheels."""

import math

from build123d import Pos, Rot, Shape, Torus

from industnerf.parts.families.drawing import (
    around,
    bar,
    block,
    hub_keyway,
    on_circle,
    rod,
    rods,
    turned,
)
from industnerf.parts.recipe import MeshBoolean, Recipe


def handwheel(diameter: float, bore: float, key: float, spokes: int) -> MeshBoolean:
    """Dished hand wheel with a revolving handle, after DIN 950 and DIN 39.

    The rim lies in the plane z = 0, the hub below.  United as meshes: OpenCASCADE loses the rim.
    """
    rim = 0.1 * diameter  # thickness
    rim_circle = diameter - rim
    hub, hub_length, dish = 0.24 * diameter, 0.19 * diameter, 0.16 * diameter
    handle, handle_length = 0.15 * diameter, 0.44 * diameter

    spoke_length = rim_circle / 2
    spoke = turned(
        [(0, 0), (0.042 * diameter, 0), (0.032 * diameter, spoke_length), (0, spoke_length)]
    )
    # from the middle of the hub outwards, climbing to the rim
    spoke = Pos(0, 0, -0.5 * dish) * Rot(0, 81, 0) * spoke
    grip = turned(
        [
            (0, -0.3 * rim),
            (0.3 * handle, -0.3 * rim),
            (0.3 * handle, 0.6 * rim),
            (0.34 * handle, 0.65 * rim),
            (0.45 * handle, 0.4 * handle_length),
            (0.5 * handle, 0.65 * handle_length),
            (0.42 * handle, 0.92 * handle_length),
            (0.25 * handle, handle_length),
            (0, handle_length),
        ]
    )
    return MeshBoolean(
        join=[
            Torus(rim_circle / 2, rim / 2),
            rod(hub, hub_length, (0, 0, -dish)),
            *around(spokes, spoke),
            Rot(0, 0, 180 / spokes) * Pos(rim_circle / 2, 0, 0) * grip,
        ],
        cut=[
            rod(bore, 2 * diameter, (0, 0, -diameter)),
            hub_keyway(bore, key, 0.45 * key, 2 * diameter, -diameter),
        ],
    )


def caster_wheel(diameter: float, width: float, hub_length: float, bore: float) -> Shape:
    """Ribbed plastic castor wheel with a crowned tread, proportions after ISO 22881."""
    rim, crown, hub, web, ribs = 0.78 * diameter, 0.96 * diameter, 2.4 * bore, 0.2 * width, 6
    profile = [
        (bore / 2, hub_length / 2),
        (hub / 2, hub_length / 2),
        (0.56 * hub, web / 2),
        (0.47 * rim, web / 2),
        (0.49 * rim, 0.42 * width),
        (0.49 * rim, 0.5 * width),
        (0.45 * diameter, 0.5 * width),
        (crown / 2, 0.4 * width),
        (0.497 * diameter, 0.2 * width),
        (diameter / 2, 0.06 * width),
    ]
    wheel = turned(profile + [(radius, -z) for radius, z in reversed(profile)])
    inside, outside = 0.45 * hub, 0.47 * rim
    rib = block(
        outside - inside, 0.1 * width, 0.66 * width, ((inside + outside) / 2, 0, -0.33 * width)
    )
    return wheel + around(ribs, rib)


def timing_pulley(teeth: int, belt: float, bore: float) -> Shape:
    """HTD 5M pulley of ISO 13050 with two flanges and a hub with set screws.

    Tooth spaces are drawn as circular arcs without their tip rounding.
    """
    pitch, pitch_line, space_depth, space_radius = 5.0, 1.143, 2.06, 1.49
    outside = teeth * pitch / math.pi - pitch_line
    face, disc, hub, hub_length = belt + 2.5, 1.2, 0.72 * outside, 8.0
    rim = turned(
        [
            (0, 0),
            (outside / 2 + 2.2, -0.6),
            (outside / 2 + 2.2, disc - 0.6),
            (outside / 2 - 0.3, disc),
            (outside / 2 - 2.5, disc),
            (0, disc),
        ]
    )
    toothed = rod(outside, face)
    centres = on_circle(teeth, outside - 2 * (space_depth - space_radius))
    toothed -= rods(centres, 2 * space_radius, face)
    pulley = toothed + Pos(0, 0, -disc) * rim + Pos(0, 0, face + disc) * Rot(180, 0, 0) * rim
    pulley += rod(hub, hub_length + disc, (0, 0, -hub_length - disc))
    screws = [
        bar(4.2, hub, axis, place)
        for axis, place in (("x", (hub / 2, 0, -5.0)), ("y", (0, hub / 2, -5.0)))
    ]
    return pulley - rod(bore, 2 * face + 2 * hub_length, (0, 0, -hub_length - 2 * disc)) - screws


RECIPES = [
    Recipe(
        "caster-wheel-d100",
        "ISO 22881 castor wheel D100-like",
        "build123d",
        caster_wheel,
        {"diameter": 100.0, "width": 32.0, "hub_length": 44.0, "bore": 12.0},
    ),
    Recipe(
        "handwheel-din950-d160",
        "DIN 950 D160-like",
        "build123d",
        handwheel,
        {"diameter": 160.0, "bore": 16.0, "key": 5.0, "spokes": 5},
    ),
    Recipe(
        "pulley-htd-5m-30",
        "ISO 13050 HTD 30-5M-15-like",
        "build123d",
        timing_pulley,
        {"teeth": 30, "belt": 15.0, "bore": 10.0},
    ),
]
