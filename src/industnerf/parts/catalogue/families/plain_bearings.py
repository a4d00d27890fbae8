"""Bushes and rod ends."""

from build123d import Shape, Sphere, fillet

from industnerf.parts.catalogue.families.drawing import (
    PRESS,
    bar,
    block,
    faced_hexagon,
    rod,
    threaded,
    turned,
)
from industnerf.parts.catalogue.recipe import Assembly, Recipe


def rod_end(
    bore: float,
    ball: float,
    ball_width: float,
    eye: float,
    width: float,
    length: float,
    flats: float,
) -> Assembly:
    """Spherical plain bearing in an eye with an internal thread, ISO 12240-4 type F (SI).

    The eye is centered on the origin, its bore along y; the shank ends `length` below.
    """
    race, neck, wrench, pitch = 0.81 * eye, 0.92 * flats, 8.0, 1.75
    body = bar(eye, width, "y")
    body = fillet(body.edges(), 1.0)
    body += turned(
        [
            (0, -length + wrench),
            (neck / 2, -length + wrench),
            (neck / 2, -0.62 * eye),
            (0.5 * width, -0.4 * eye),
            (0, -0.4 * eye),
        ]
    )
    body += faced_hexagon(flats, wrench, (0, 0, -length))
    body -= threaded(bore, pitch, 0.5 * length, (0, 0, -length))
    body -= bar(race - 2 * PRESS, width, "y")
    swivel = Sphere(ball / 2) & block(ball, ball_width, ball, (0, 0, -ball / 2))
    return Assembly(
        {
            "zinc": body,
            "bronze": bar(race, width - 0.6, "y") - bar(1.2 * bore, width, "y"),
            "bright steel": swivel - bar(bore, ball_width, "y"),
        }
    )


def flanged_bush(bore: float, outside: float, flange: float, collar: float, length: float) -> Shape:
    """ISO 4379 form F, with an oil hole and a groove inside; the flange stands on z = 0."""
    lead, edge, oil, depth = 1.5, 0.5, 4.0, 0.8
    bush = turned(
        [
            (bore / 2 + edge, 0),
            (flange / 2 - edge, 0),
            (flange / 2, edge),
            (flange / 2, collar),
            (outside / 2, collar),
            (outside / 2, length - lead),
            (outside / 2 - edge, length),
            (bore / 2 + edge, length),
            (bore / 2, length - edge),
            (bore / 2, edge),
        ]
    )
    middle = (collar + length) / 2
    bush -= rod(bore + 2 * depth, oil, (0, 0, middle - oil / 2))
    return bush - bar(oil, flange, "x", (flange / 2, 0, middle))


RECIPES = [
    Recipe(
        "bush-flanged-iso4379-20x26x30",
        "ISO 4379 F 20x26x30-like",
        "build123d",
        flanged_bush,
        {"bore": 20.0, "outside": 26.0, "flange": 32.0, "collar": 3.0, "length": 30.0},
        finish="bronze",
    ),
    Recipe(
        "rod-end-iso12240-4-si12",
        "ISO 12240-4 K SI12-like",
        "build123d",
        rod_end,
        {
            "bore": 12.0,
            "ball": 22.225,
            "ball_width": 16.0,
            "eye": 32.0,
            "width": 12.0,
            "length": 50.0,
            "flats": 19.0,
        },
    ),
]
