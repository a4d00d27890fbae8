"""Nuts with their real threads, from the tables of bd_warehouse."""

from bd_warehouse.fastener import DomedCapNut, HexNut
from build123d import Shape

from industnerf.parts.recipe import Recipe


def domed_cap_nut(size: str) -> Shape:
    """DIN 1587."""
    return DomedCapNut(size, "din1587", simple=False)


def hexagon_nut(size: str) -> Shape:
    """ISO 4032."""
    return HexNut(size, "iso4032", simple=False)


RECIPES = [
    Recipe(
        "cap-nut-din1587-m10",
        "DIN 1587 M10",
        "bd_warehouse",
        domed_cap_nut,
        {"size": "M10-1.5"},
    ),
    Recipe(
        "nut-iso4032-m16",
        "ISO 4032 M16",
        "bd_warehouse",
        hexagon_nut,
        {"size": "M16-2"},
    ),
]
