"""Bearings."""

from industnerf.parts.families import (
    ball_bearings,
    bearing_units,
    plain_bearings,
    roller_bearings,
)
from industnerf.parts.recipe import Recipe

RECIPES: list[Recipe] = [
    *ball_bearings.RECIPES,
    *roller_bearings.RECIPES,
    *plain_bearings.RECIPES,
    *bearing_units.RECIPES,
]
