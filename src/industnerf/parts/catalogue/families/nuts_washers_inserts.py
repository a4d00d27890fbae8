"""Nuts and inserts with their real threads, and washers, from the tables of bd_warehouse."""

from bd_warehouse.fastener import (
    DomedCapNut,
    HeatSetNut,
    HexNut,
    HexNutWithFlange,
    InternalToothLockWasher,
    SquareNut,
)
from build123d import Shape

from industnerf.parts.catalogue.recipe import Recipe


def domed_cap_nut(size: str) -> Shape:
    """DIN 1587."""
    return DomedCapNut(size, "din1587", simple=False)


def flange_nut(size: str) -> Shape:
    """EN 1661; bd_warehouse keeps its table under DIN 1665."""
    return HexNutWithFlange(size, "din1665", simple=False)


def heat_set_insert(size: str) -> Shape:
    """Two knurls of opposite hand; `size` ends with the length."""
    return HeatSetNut(size, "CNCKitchen", simple=False)


def hexagon_nut(size: str) -> Shape:
    """ISO 4032."""
    return HexNut(size, "iso4032", simple=False)


def square_nut(size: str) -> Shape:
    """DIN 557."""
    return SquareNut(size, "din557", simple=False)


def toothed_washer(size: str) -> Shape:
    """DIN 6797 J: twisted teeth inside."""
    return InternalToothLockWasher(size, "din6797")


RECIPES = [
    Recipe(
        "cap-nut-din1587-m10",
        "DIN 1587 M10",
        "bd_warehouse",
        domed_cap_nut,
        {"size": "M10-1.5"},
        finish="bright steel",
    ),
    Recipe(
        "insert-heat-set-m5x5-8",
        "heat-set insert M5x5.8",
        "bd_warehouse",
        heat_set_insert,
        {"size": "M5-0.8-5.8"},
        finish="brass",
    ),
    Recipe(
        "nut-flange-en1661-m12",
        "EN 1661 M12",
        "bd_warehouse",
        flange_nut,
        {"size": "M12-1.75"},
        finish="zinc",
    ),
    Recipe(
        "nut-iso4032-m16",
        "ISO 4032 M16",
        "bd_warehouse",
        hexagon_nut,
        {"size": "M16-2"},
        finish="zinc",
    ),
    Recipe(
        "nut-square-din557-m12",
        "DIN 557 M12",
        "bd_warehouse",
        square_nut,
        {"size": "M12-1.75"},
        finish="black oxide",
    ),
    Recipe(
        "washer-toothed-din6797-m12",
        "DIN 6797 J 13",
        "bd_warehouse",
        toothed_washer,
        {"size": "M12"},
    ),
]
