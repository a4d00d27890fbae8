"""Gears on crossed axes: worm, worm wheel and bevel gears."""

import math

import py_gearworks
from bd_warehouse.gear import Worm, WormWheel
from build123d import Pos, Shape, Torus

from industnerf.parts.catalogue.families.drawing import (
    Real,
    chamfered_rod,
    keyed_bore,
    rod,
    tube,
    turned,
)
from industnerf.parts.catalogue.recipe import Assembly, MeshBoolean, Recipe

DIAMETRAL_QUOTIENT = 10  # of worm and wheel: reference diameter of the worm / module


def worm_shaft(module: Real, starts: int, length: Real, shaft: Real, overall: Real) -> MeshBoolean:
    """Right-hand ZI worm cut on its shaft; bearing seats at both ends, centered on the origin.

    United as meshes: OpenCASCADE's union is not valid.
    """
    root, tip = module * (DIAMETRAL_QUOTIENT - 2.4), module * (DIAMETRAL_QUOTIENT + 2)
    worm = Worm(module, starts, DIAMETRAL_QUOTIENT, length)
    # the thread ends in a cone down to its root
    blank = chamfered_rod(tip, length, (tip - root) / 2, (0, 0, -length / 2))
    collar = chamfered_rod(root, length + 4 * module, 1.0, (0, 0, -length / 2 - 2 * module))
    seats = chamfered_rod(shaft, overall, 1.0, (0, 0, -overall / 2))
    center = turned([(0, -1), (3, -1), (3, 0), (1.2, 3), (1.2, 5), (0, 6)])
    low, high = Pos(0, 0, -overall / 2) * center, Pos(0, 0, overall / 2) * center.mirror()
    return MeshBoolean(join=[worm & blank, collar, seats], cut=[low, high])


def worm_wheel(module: Real, teeth: int, width: Real, bore: Real, key: Real) -> Assembly:
    """Bronze rim on a cast hub, its tips hollowed to the worm's radius; the hub is longer below."""
    worm, pitch = module * DIAMETRAL_QUOTIENT, module * teeth
    rim = WormWheel(module, teeth, width, addendum=1.4 * module)
    throat = Torus((pitch + worm) / 2, worm / 2 - module)
    joint, hub, low = pitch - 8 * module, 1.8 * bore, -0.75 * width
    center = tube(joint, hub, 0.4 * width, (0, 0, -0.2 * width))
    center += rod(hub, 1.5 * width, (0, 0, low))
    center += tube(joint, joint - 3 * module, width, (0, 0, -width / 2))
    return Assembly(
        {
            "bronze": rim - rod(joint, 2 * width, (0, 0, -width)) - throat,
            "cast iron": center - keyed_bore(bore, key, 2 * width, -width),
        }
    )


def bevel_gear(
    module: Real, teeth: int, tooth_length: Real, spiral_angle: Real, bore: Real, key: Real
) -> Shape:
    """Bevel gear for equal partners on square axes; the pitch circle lies in the plane z = 0."""
    gear = py_gearworks.BevelGear(
        teeth,
        cone_angle=math.pi / 2,
        helix_angle=math.radians(spiral_angle),
        height=tooth_length,
        module=module,
    ).build_part()
    hub, back = 2 * bore, -0.25 * module * teeth
    gear += rod(hub, -back, (0, 0, back))
    return gear - keyed_bore(bore, key, 2 * module * teeth, -module * teeth)


BEVEL = {"module": 2.5, "teeth": 24, "tooth_length": 12.0, "bore": 15.0, "key": 5.0}

RECIPES = [
    Recipe(
        "worm-m3-z1",
        "ZI worm m3 z1 q10, right-hand",
        "bd_warehouse",
        worm_shaft,
        {"module": 3.0, "starts": 1, "length": 50.0, "shaft": 17.0, "overall": 120.0},
    ),
    Recipe(
        "worm-wheel-m3-z30",
        "worm wheel m3 z30 q10, bronze rim",
        "bd_warehouse",
        worm_wheel,
        {"module": 3.0, "teeth": 30, "width": 22.0, "bore": 20.0, "key": 6.0},
    ),
    Recipe(
        "gear-bevel-m2-5-z24",
        "straight bevel gear m2.5 z24, 45 deg",
        "py_gearworks",
        bevel_gear,
        BEVEL | {"spiral_angle": 0.0},
    ),
    Recipe(
        "gear-bevel-spiral-m2-5-z24",
        "spiral bevel gear m2.5 z24, 45 deg, spiral 30 deg",
        "py_gearworks",
        bevel_gear,
        BEVEL | {"spiral_angle": 30.0},
    ),
]
