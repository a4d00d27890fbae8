"""Enclosures and gearbox housings; also `motors` and `pump_casings`."""

from build123d import Axis, Shape, fillet

from industnerf.parts.catalogue.families import motors, pump_casings
from industnerf.parts.catalogue.families.drawing import bar, block, on_grid, rods, rounded_block
from industnerf.parts.catalogue.recipe import Recipe


def enclosure(length: float, width: float, height: float, wall: float) -> Shape:
    """Open electronics box: screw posts, a lip for the lid, vents and two cut-outs."""
    corner, post, pilot = 8.0, 9.0, 3.2
    lip_depth, lip_wall = 2.0, wall / 2
    box = rounded_block(length, width, height, corner)
    box = fillet(box.faces().sort_by(Axis.Z)[0].edges(), 3.0)
    inside = rounded_block(length - 2 * wall, width - 2 * wall, height, corner - wall, (0, 0, wall))
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


def gearbox_housing(center_distance: float, input_bearing: float, output_bearing: float) -> Shape:
    """Open cast housing of a one-stage gearbox: bearing seats in y, flange on top, feet below.

    Seats are drilled through, so both bearings can be pressed in from outside.
    """
    wall, floor, flange_width, flange = 8.0, 10.0, 14.0, 12.0
    length = center_distance + 0.62 * (input_bearing + output_bearing) + 40
    width, height = 100.0, 0.9 * output_bearing + 62
    axis_height, boss_wall, boss_length = 0.52 * height, 10.0, 22.0
    x_input = -center_distance / 2 - 0.05 * length
    seats = [(x_input, input_bearing), (x_input + center_distance, output_bearing)]

    cavity = rounded_block(length - 2 * wall, width - 2 * wall, height, 10.0, (0, 0, floor))
    body = rounded_block(length, width, height, 10.0 + wall)
    rim = rounded_block(
        length + 2 * flange_width,
        width + 2 * flange_width,
        flange,
        10.0 + wall + flange_width,
        (0, 0, height - flange),
    )
    body += rim
    feet = [(side * 0.36 * length, 0) for side in (1, -1)]
    body += [rounded_block(34.0, width + 52, floor + 3, 6.0, (x, y, 0)) for x, y in feet]
    body -= cavity
    for x, seat in seats:
        outer = seat + 2 * boss_wall
        for side in (1, -1):
            middle = side * (width / 2 + 0.5 * boss_length - wall - 3)
            body += bar(outer, boss_length, "y", (x, middle, axis_height))
            body += block(wall, 14.0, axis_height, (x, side * (width / 2 + 5), 0))  # rib
        body -= bar(seat, 2 * width, "y", (x, 0, axis_height))
    bolts = on_grid(length - 26, width + flange_width)
    bolts += [
        (x, side * (width + flange_width) / 2)
        for x in (-0.16 * length, 0.16 * length)
        for side in (1, -1)
    ]
    bolts += on_grid(length + flange_width, 0.44 * width)
    body -= rods(bolts, 6.8, 2 * flange, height - 2 * flange + 2)
    anchors = [(x, side * (width / 2 + 17)) for x, _ in feet for side in (1, -1)]
    body -= rods(anchors, 11.0, 2 * floor)
    drain = (length / 2, 0.0, floor + 9)
    return body + bar(24.0, 8.0, "x", drain) - bar(14.0, 6 * wall, "x", drain)


RECIPES = [
    Recipe(
        "enclosure-120x80x40",
        "electronics enclosure 120x80x40",
        "build123d",
        enclosure,
        {"length": 120.0, "width": 80.0, "height": 40.0, "wall": 3.0},
        finish="aluminum",
    ),
    Recipe(
        "gearbox-housing-a75",
        "one-stage gearbox housing, centers 75, bearings 47 and 62",
        "build123d",
        gearbox_housing,
        {"center_distance": 75.0, "input_bearing": 47.0, "output_bearing": 62.0},
        finish="green paint",
    ),
    *motors.RECIPES,
    *pump_casings.RECIPES,
]
