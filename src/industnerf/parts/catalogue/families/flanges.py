"""Pipe flanges of ASME B16.5, from the tables of bd_warehouse."""

from bd_warehouse.flange import (
    BlindFlange,
    LappedFlange,
    SlipOnFlange,
    SocketWeldFlange,
    WeldNeckFlange,
)
from build123d import Shape

from industnerf.parts.catalogue.recipe import Recipe

# `nps` is in inches; a `face` is "Flat", "Raised" or "Ring".


def blind(nps: str, pressure_class: int, face: str) -> Shape:
    """A disc that closes a pipe."""
    return BlindFlange(nps, pressure_class, face)


def lapped(nps: str, pressure_class: int) -> Shape:
    """Loose behind the lap of a stub end, round which its bore is rounded."""
    return LappedFlange(nps, pressure_class)


def slip_on(nps: str, pressure_class: int, face: str) -> Shape:
    """The pipe goes through, and is welded inside and outside."""
    return SlipOnFlange(nps, pressure_class, face)


def socket_weld(nps: str, pressure_class: int, face: str) -> Shape:
    """The pipe ends on a shoulder of the bore."""
    return SocketWeldFlange(nps, pressure_class, face)


def weld_neck(nps: str, pressure_class: int, face: str) -> Shape:
    """A tapered hub as thick as the pipe's wall at its end."""
    return WeldNeckFlange(nps, pressure_class, face)


RECIPES = [
    Recipe(
        "flange-blind-b16-5-nps4-cl150",
        "ASME B16.5 blind NPS 4 class 150 RF",
        "bd_warehouse",
        blind,
        {"nps": "4", "pressure_class": 150, "face": "Raised"},
    ),
    Recipe(
        "flange-lapped-b16-5-nps8-cl150",
        "ASME B16.5 lapped NPS 8 class 150",
        "bd_warehouse",
        lapped,
        {"nps": "8", "pressure_class": 150},
        finish="zinc",
    ),
    Recipe(
        "flange-slipon-b16-5-nps6-cl300",
        "ASME B16.5 slip-on NPS 6 class 300 RF",
        "bd_warehouse",
        slip_on,
        {"nps": "6", "pressure_class": 300, "face": "Raised"},
    ),
    Recipe(
        "flange-socketweld-b16-5-nps2-cl150",
        "ASME B16.5 socket weld NPS 2 class 150 RF",
        "bd_warehouse",
        socket_weld,
        {"nps": "2", "pressure_class": 150, "face": "Raised"},
        finish="bright steel",
    ),
    Recipe(
        "flange-weldneck-b16-5-nps4-cl300",
        "ASME B16.5 weld neck NPS 4 class 300 RTJ",
        "bd_warehouse",
        weld_neck,
        {"nps": "4", "pressure_class": 300, "face": "Ring"},
    ),
]
