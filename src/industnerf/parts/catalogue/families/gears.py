"""Toothed wheels and racks on parallel axes."""

import math

from bd_warehouse.gear import HelicalGear, RackGear, SpurGear
from build123d import Plane, Pos, Shape

from industnerf.parts.catalogue.families import gear_trains, worm_bevel_gears
from industnerf.parts.catalogue.families.drawing import (
    Real,
    bar,
    chamfered_rod,
    keyed_bore,
    on_circle,
    rod,
    rods,
    tube,
)
from industnerf.parts.catalogue.recipe import MeshBoolean, Recipe


def spur_gear(
    module: Real, teeth: int, face_width: Real, bore: Real, key: Real, web: Real, holes: int
) -> Shape:
    """ISO 53 profile of 20 degrees; between rim and hub a web, `holes` in it."""
    low, outside = -face_width / 2, module * (teeth + 2)
    rim, hub = module * (teeth - 2.5) - 5 * module, 1.6 * bore
    gear = SpurGear(module, teeth, 20, face_width, root_fillet=0.2 * module)
    gear &= chamfered_rod(outside, face_width, 0.3 * module, (0, 0, low))
    gear -= [tube(rim, hub, face_width, (0, 0, z)) for z in (web / 2, -web / 2 - face_width)]
    gear -= rods(on_circle(holes, (rim + hub) / 2), 0.3 * (rim - hub), web, -web / 2)
    return gear - keyed_bore(bore, key, face_width, low)


def helical_gear(
    module: Real, teeth: int, helix_angle: Real, face_width: Real, bore: Real, key: Real
) -> Shape:
    """ISO 53 profile of 20 degrees, with a hub on one side and a keyway of DIN 6885-1."""
    hub_length = 0.6 * face_width
    gear = HelicalGear(module, teeth, 20, helix_angle, face_width)
    box = gear.bounding_box()
    gear += rod(1.8 * bore, hub_length, (0, 0, box.max.Z))
    return gear - keyed_bore(bore, key, box.size.Z + hub_length, box.min.Z, 0.42 * key)


def herringbone_gear(
    module: Real, teeth: int, helix_angle: Real, face_width: Real, bore: Real, key: Real
) -> MeshBoolean:
    """Two helices of opposite hand, a groove for the hob between; `module` is the normal one.

    United as meshes: OpenCASCADE takes 20 s.
    """
    # Not py_gearworks' own: its herringbone gear has straight teeth (0.0.24).
    groove = 2 * module
    half = (face_width - groove) / 2
    low = Pos(0, 0, half / 2) * HelicalGear(module, teeth, 20, helix_angle, half)
    high = low.mirror(Plane.XY.offset(face_width / 2))
    pitch = module * teeth / math.cos(math.radians(helix_angle))
    rim, hub, recess = pitch - 8 * module, 1.8 * bore, 0.2 * face_width
    recesses = [tube(rim, hub, 2 * recess, (0, 0, z - recess)) for z in (0, face_width)]
    return MeshBoolean(
        join=[low, high, rod(pitch - 3 * module, face_width - module, (0, 0, module / 2))],
        cut=[*recesses, *keyed_bore(bore, key, 2 * face_width, -face_width / 2)],
    )


def rack(module: Real, teeth: int, width: Real, height: Real, screw: Real) -> Shape:
    """Straight rack along x, `height` to the pitch line, held by two socket screws along y."""
    body = RackGear(
        module, teeth, 20, width, root_fillet=0.2 * module, base_height=height - 1.25 * module
    )
    head, depth = 1.7 * screw, 0.9 * screw
    for x in (-0.25 * math.pi * module * teeth, 0.25 * math.pi * module * teeth):
        location = Pos(x, 0, -0.6 * height)
        body -= location * bar(1.1 * screw, width, "y")
        body -= location * bar(head, 2 * depth, "y", (0, -width / 2, 0))
    return body


RECIPES = [
    Recipe(
        "gear-spur-m2-z24",
        "ISO 53 m2 z24, 20 wide",
        "bd_warehouse",
        spur_gear,
        {
            "module": 2.0,
            "teeth": 24,
            "face_width": 20.0,
            "bore": 12.0,
            "key": 4.0,
            "web": 8.0,
            "holes": 6,
        },
    ),
    Recipe(
        "gear-helical-m3-z30",
        "ISO 53 m3 z30, helix 20 deg, 25 wide",
        "bd_warehouse",
        helical_gear,
        {
            "module": 3.0,
            "teeth": 30,
            "helix_angle": 20.0,
            "face_width": 25.0,
            "bore": 24.0,
            "key": 8.0,
        },
    ),
    Recipe(
        "gear-herringbone-m2-z30",
        "double helical (herringbone) gear m2 z30, 30 deg, 30 wide",
        "bd_warehouse",
        herringbone_gear,
        {
            "module": 2.0,
            "teeth": 30,
            "helix_angle": 30.0,
            "face_width": 30.0,
            "bore": 20.0,
            "key": 6.0,
        },
    ),
    Recipe(
        "rack-m2-z16",
        "ISO 53 rack m2, 16 teeth, 20x20",
        "bd_warehouse",
        rack,
        {"module": 2.0, "teeth": 16, "width": 20.0, "height": 18.0, "screw": 6.0},
    ),
    *gear_trains.RECIPES,
    *worm_bevel_gears.RECIPES,
]
