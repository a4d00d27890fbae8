"""Heat sinks and heat exchangers."""

from build123d import Shape

from industnerf.parts.families.drawing import block, on_grid, rods
from industnerf.parts.recipe import Recipe


def plate_fin_sink(
    width: float, length: float, height: float, base: float, fins: int, fin: float
) -> Shape:
    """Extruded heat sink, fins along y, with four mounting holes between the fins."""
    pitch = (width - fin) / (fins - 1)
    sink = block(width, length, base)
    sink += [
        block(fin, length, height - 0.5 * base, ((i - (fins - 1) / 2) * pitch, 0, 0.5 * base))
        for i in range(fins)
    ]
    holes = on_grid((fins - 4) * pitch, 0.75 * length)
    return sink - rods(holes, 3.4, base)


RECIPES = [
    Recipe(
        "heat-sink-plate-fin-80x60",
        "extruded heat sink 80x60x36, 16 fins",
        "build123d",
        plate_fin_sink,
        {"width": 80.0, "length": 60.0, "height": 36.0, "base": 6.0, "fins": 16, "fin": 1.6},
    ),
]
