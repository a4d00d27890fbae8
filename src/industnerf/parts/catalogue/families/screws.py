"""Screws with their real threads, from the tables of bd_warehouse."""

from bd_warehouse.fastener import (
    ButtonHeadScrew,
    CounterSunkScrew,
    HexHeadScrew,
    HexHeadWithFlangeScrew,
    PanHeadScrew,
    SetScrew,
    ShoulderScrew,
    SocketHeadCapScrew,
)
from build123d import Shape

from industnerf.parts.catalogue.recipe import Recipe


def hexagon_head(size: str, length: float) -> Shape:
    """ISO 4014, partly threaded."""
    return HexHeadScrew(size, length, "iso4014", simple=False)


def socket_head(size: str, length: float) -> Shape:
    """ISO 4762, hexagon socket."""
    return SocketHeadCapScrew(size, length, "iso4762", simple=False)


def countersunk_head(size: str, length: float) -> Shape:
    """ISO 10642, hexagon socket; `length` is overall."""
    return CounterSunkScrew(size, length, "iso10642", simple=False)


def button_head(size: str, length: float) -> Shape:
    """ISO 7380-1, hexagon socket."""
    return ButtonHeadScrew(size, length, "iso7380_1", simple=False)


def flange_head(size: str, length: float) -> Shape:
    """DIN EN 1662, hexagon with flange, small series."""
    return HexHeadWithFlangeScrew(size, length, "din1662", simple=False)


def pan_head(size: str, length: float) -> Shape:
    """ISO 14583, hexalobular socket."""
    return PanHeadScrew(size, length, "iso14583", simple=False)


def shoulder_screw(size: str, length: float) -> Shape:
    """ISO 7379, hexagon socket; `length` is the shoulder's."""
    return ShoulderScrew(size, length, "iso7379", simple=False)


def set_screw(size: str, length: float) -> Shape:
    """ISO 4026, hexagon socket and flat point."""
    return SetScrew(size, length, "iso4026", simple=False)


RECIPES = [
    Recipe(
        "screw-iso4014-m12x80",
        "ISO 4014 M12x80",
        "bd_warehouse",
        hexagon_head,
        {"size": "M12-1.75", "length": 80.0},
        finish="zinc",
    ),
    Recipe(
        "screw-iso4762-m10x40",
        "ISO 4762 M10x40",
        "bd_warehouse",
        socket_head,
        {"size": "M10-1.5", "length": 40.0},
        finish="black oxide",
    ),
    Recipe(
        "screw-iso10642-m8x30",
        "ISO 10642 M8x30",
        "bd_warehouse",
        countersunk_head,
        {"size": "M8-1.25", "length": 30.0},
        finish="black oxide",
    ),
    Recipe(
        "screw-iso7380-m8x25",
        "ISO 7380-1 M8x25",
        "bd_warehouse",
        button_head,
        {"size": "M8-1.25", "length": 25.0},
        finish="bright steel",
    ),
    Recipe(
        "screw-flange-en1662-m10x35",
        "EN 1662 M10x35",
        "bd_warehouse",
        flange_head,
        {"size": "M10-1.5", "length": 35.0},
        finish="zinc",
    ),
    Recipe(
        "screw-iso14583-m6x25",
        "ISO 14583 M6x25",
        "bd_warehouse",
        pan_head,
        {"size": "M6-1", "length": 25.0},
        finish="zinc",
    ),
    Recipe(
        "screw-shoulder-iso7379-10x40-m8",
        "ISO 7379 10x40-M8",
        "bd_warehouse",
        shoulder_screw,
        {"size": "M8-1.25", "length": 40.0},
        finish="black oxide",
    ),
    Recipe(
        "screw-set-iso4026-m12x25",
        "ISO 4026 M12x25",
        "bd_warehouse",
        set_screw,
        {"size": "M12-1.75", "length": 25.0},
        finish="black oxide",
    ),
]
