"""The families of the embedded set.  To add a part, add a recipe to its family's list."""

from industnerf.parts.families import (
    bearings,
    brackets_structure,
    drives_wheels,
    gears,
    housings_motors,
    linear_springs,
    screws,
    shafts_couplings,
)
from industnerf.parts.recipe import Recipe

FAMILIES: dict[str, list[Recipe]] = {
    "bearings": bearings.RECIPES,
    "brackets_structure": brackets_structure.RECIPES,
    "drives_wheels": drives_wheels.RECIPES,
    "gears": gears.RECIPES,
    "housings_motors": housings_motors.RECIPES,
    "linear_springs": linear_springs.RECIPES,
    "screws": screws.RECIPES,
    "shafts_couplings": shafts_couplings.RECIPES,
}
