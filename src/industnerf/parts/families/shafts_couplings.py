"""Shafts and couplings."""

from bd_warehouse.open_builds import FlexibleCoupler
from build123d import Shape

from industnerf.parts.recipe import Recipe


def helical_beam_coupler(bore: str) -> Shape:
    """OpenBuilds flexible coupler, 5 mm to `bore`."""
    return FlexibleCoupler(bore)


RECIPES = [
    Recipe(
        "coupler-helical-beam-8mm",
        "OpenBuilds flexible coupler 5x8",
        "bd_warehouse",
        helical_beam_coupler,
        {"bore": "8mm"},
    ),
]
