"""Screws with their real threads, from the tables of bd_warehouse."""

from bd_warehouse.fastener import ButtonHeadScrew, HexHeadScrew
from build123d import Shape

from industnerf.parts.recipe import Recipe


def hexagon_head(size: str, length: float) -> Shape:
    """ISO 4014, partly threaded."""
    return HexHeadScrew(size, length, "iso4014", simple=False)


def button_head(size: str, length: float) -> Shape:
    """ISO 7380-1, hexagon socket."""
    return ButtonHeadScrew(size, length, "iso7380_1", simple=False)


RECIPES = [
    Recipe(
        "screw-iso4014-m12x80",
        "ISO 4014 M12x80",
        "bd_warehouse",
        hexagon_head,
        {"size": "M12-1.75", "length": 80.0},
    ),
    Recipe(
        "screw-iso7380-m8x25",
        "ISO 7380-1 M8x25",
        "bd_warehouse",
        button_head,
        {"size": "M8-1.25", "length": 25.0},
    ),
]
