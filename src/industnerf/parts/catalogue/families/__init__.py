"""The families of the embedded set.  To add a part, add a recipe to its family's list."""

from industnerf.parts.catalogue.families import (
    ball_bearings,
    bearing_units,
    brackets_structure,
    drives_wheels,
    engine,
    flanges,
    gears,
    housings_motors,
    linear_springs,
    nuts_washers_inserts,
    pipe_fittings,
    plain_bearings,
    roller_bearings,
    rotors,
    screws,
    shafts_couplings,
    thermal,
    tooling_misc,
    valves_fluid,
)
from industnerf.parts.catalogue.recipe import Recipe

FAMILIES: dict[str, list[Recipe]] = {
    "bearings": [
        *ball_bearings.RECIPES,
        *roller_bearings.RECIPES,
        *plain_bearings.RECIPES,
        *bearing_units.RECIPES,
    ],
    "brackets_structure": brackets_structure.RECIPES,
    "drives_wheels": drives_wheels.RECIPES,
    "engine": engine.RECIPES,
    "flanges": flanges.RECIPES,
    "gears": gears.RECIPES,
    "housings_motors": housings_motors.RECIPES,
    "linear_springs": linear_springs.RECIPES,
    "nuts_washers_inserts": nuts_washers_inserts.RECIPES,
    "pipe_fittings": pipe_fittings.RECIPES,
    "rotors": rotors.RECIPES,
    "screws": screws.RECIPES,
    "shafts_couplings": shafts_couplings.RECIPES,
    "thermal": thermal.RECIPES,
    "tooling_misc": tooling_misc.RECIPES,
    "valves_fluid": valves_fluid.RECIPES,
}
