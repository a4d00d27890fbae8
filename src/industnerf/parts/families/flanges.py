"""Pipe flanges of ASME B16.5, from the tables of bd_warehouse."""

from bd_warehouse.flange import WeldNeckFlange
from build123d import Shape

from industnerf.parts.recipe import Recipe


def weld_neck(nps: str, pressure_class: int, face: str) -> Shape:
    """Weld neck; `face` is "Flat", "Raised" or "Ring", `nps` in inches."""
    return WeldNeckFlange(nps, pressure_class, face)


RECIPES = [
    Recipe(
        "flange-weldneck-b16-5-nps4-cl300",
        "ASME B16.5 weld neck NPS 4 class 300 RTJ",
        "bd_warehouse",
        weld_neck,
        {"nps": "4", "pressure_class": 300, "face": "Ring"},
    ),
]
