"""Toothed wheels."""

import py_gearworks
from bd_warehouse.gear import HelicalGear
from build123d import Shape

from industnerf.parts.families.drawing import hub_keyway, on_circle, rod, rods
from industnerf.parts.recipe import Recipe


def helical_gear(
    module: float, teeth: int, helix_angle: float, face_width: float, bore: float, key: float
) -> Shape:
    """ISO 53 profile of 20 degrees, with a hub on one side and a keyway of DIN 6885-1."""
    hub_length = 0.6 * face_width
    gear = HelicalGear(module, teeth, 20, helix_angle, face_width)
    top = gear.bounding_box().max.Z
    height = top + hub_length - gear.bounding_box().min.Z
    gear += rod(1.8 * bore, hub_length, (0, 0, top))
    gear -= rod(bore, height, (0, 0, top + hub_length - height))
    return gear - hub_keyway(bore, key, 0.42 * key, height, top + hub_length - height)


def ring_gear(module: float, teeth: int, width: float, bolts: int, bolt_hole: float) -> Shape:
    """Internal gear of 20 degrees, bolted through its rim."""
    rim = 8.0  # modules from the pitch circle to the outside
    ring = py_gearworks.SpurRingGear(
        teeth, height=width, module=module, outside_ring_coefficient=rim
    ).build_part()
    bolt_circle = module * (teeth + 1.2 * rim)
    return ring - rods(on_circle(bolts, bolt_circle), bolt_hole, 2 * width, -width / 2)


RECIPES = [
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
        "gear-ring-m1-5-z60",
        "ISO 53 internal, m1.5 z60, 15 wide",
        "py_gearworks",
        ring_gear,
        {"module": 1.5, "teeth": 60, "width": 15.0, "bolts": 6, "bolt_hole": 5.5},
    ),
]
