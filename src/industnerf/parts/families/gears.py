"""Toothed wheels."""

from bd_warehouse.gear import HelicalGear
from build123d import Shape

from industnerf.parts.families.drawing import hub_keyway, rod
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


RECIPES = [
    Recipe(
        "gear-helical-m3-z30",
        "ISO 53 m3 z30, helix 20 deg, 25 wide",
        "bd_warehouse",
        helical_gear,
        {"module": 3, "teeth": 30, "helix_angle": 20, "face_width": 25, "bore": 24, "key": 8},
    ),
]
