"""Bearings."""

from industnerf.parts.catalogue.families import (
    ball_bearings,
    bearing_units,
    plain_bearings,
    roller_bearings,
)
from industnerf.parts.catalogue.recipe import Recipe

RECIPES: list[Recipe] = [
    *ball_bearings.RECIPES,
    *roller_bearings.RECIPES,
    *plain_bearings.RECIPES,
    *bearing_units.RECIPES,
]
