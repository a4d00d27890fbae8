"""Enclosures, housings and motors."""

from build123d import Axis, Shape, fillet

from industnerf.parts.families.drawing import (
    bar,
    block,
    on_grid,
    rod,
    rods,
    rounded_block,
)
from industnerf.parts.recipe import Recipe


def enclosure(length: float, width: float, height: float, wall: float) -> Shape:
    """Open electronics box: screw posts, a lip for the lid, vents and two cut-outs."""
    corner, post, pilot = 8.0, 9.0, 3.2
    lip_depth, lip_wall = 2.0, wall / 2
    box = rounded_block(length, width, height, corner)
    box = fillet(box.faces().sort_by(Axis.Z)[0].edges(), 3.0)
    inside = rounded_block(
        length - 2 * wall, width - 2 * wall, height, corner - wall, (0, 0, wall)
    )
    box -= inside
    posts = on_grid(length - 2 * wall - post, width - 2 * wall - post)
    box += rods(posts, post, height - wall - lip_depth, wall)
    box -= rods(posts, pilot, height, height / 2)
    box -= rounded_block(
        length - 2 * lip_wall,
        width - 2 * lip_wall,
        height,
        corner - lip_wall,
        (0, 0, height - lip_depth),
    )
    vents = [y * 7.0 for y in range(-3, 4)]
    box -= [block(3 * wall, 3.0, 0.45 * height, (-length / 2, y, 0.3 * height)) for y in vents]
    box -= bar(16.0, 3 * wall, "x", (length / 2, 0, 0.52 * height))  # M16 cable gland
    box -= block(30.0, 3 * wall, 12.0, (0.1 * length, -width / 2, 0.3 * height))
    bosses = rods(on_grid(0.5 * length, 0.4 * width), 6.0, 5.0, wall)
    return box + bosses - rods(on_grid(0.5 * length, 0.4 * width), 2.5, 5.0, wall + 1)


RECIPES = [
    Recipe(
        "enclosure-120x80x40",
        "electronics enclosure 120x80x40",
        "build123d",
        enclosure,
        {"length": 120, "width": 80, "height": 40, "wall": 3},
    ),
]
