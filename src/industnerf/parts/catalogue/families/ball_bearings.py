"""Ball bearings: boundary dimensions of ISO 15 and ISO 104, the inside drawn by us.

A bearing stands on z = 0, about z.  Balls have a little play between their raceways, and cages no
pockets: two rings, and balls and cage in one piece.
"""

from build123d import Circle, Pos, Shape, Sphere

from industnerf.parts.catalogue.families.drawing import copies_on_circle, half_section, spun, turned
from industnerf.parts.catalogue.recipe import Assembly, MeshBoolean, Recipe

PLAY = 0.01  # of a ball's or roller's diameter, on each side


def assembled(rings: list[Shape], rolling: list[Shape], cage: Shape) -> Assembly:
    """The bearing with the finishes of its bodies."""
    return Assembly(
        {
            "steel": MeshBoolean(join=rings, cut=[]),
            "bright steel": MeshBoolean(join=rolling, cut=[]),
            "brass": cage,
        }
    )


def ball_bearing(
    bore: float, outside: float, width: float, ball: float, balls: int, open_side: float
) -> Assembly:
    """Single row of balls in grooves 0.2 balls deep, with a machined cage.

    On one side the outer ring's shoulder is lower by `open_side`, a share of the ball: nearly
    gone (0.17) for angular contact, 0 for a deep groove.
    """
    pitch, middle, corner, groove = (bore + outside) / 2, width / 2, 0.05 * width, 0.52 * ball
    sunk = groove - (0.5 + PLAY) * ball  # of the grooves' centers, from the balls' towards them
    inner = half_section(bore, pitch - 0.6 * ball, 0, width, corner)
    inner -= Pos(pitch / 2 + sunk, middle) * Circle(groove)
    outer = half_section(pitch + 0.6 * ball, outside, 0, width, corner)
    outer -= Pos(pitch / 2 - sunk, middle) * Circle(groove)
    outer -= half_section(pitch, pitch + (0.6 + 2 * open_side) * ball, middle, 2 * width)
    cage = half_section(
        pitch - 0.4 * ball, pitch + 0.4 * ball, middle - 0.36 * ball, middle + 0.36 * ball
    )
    rolling = copies_on_circle(balls, Pos(pitch / 2, 0, middle) * Sphere(ball / 2))
    return assembled([spun(inner), spun(outer)], rolling, spun(cage))


def shielded_bearing(bore: float, outside: float, width: float, land: float) -> Assembly:
    """Deep groove ball bearing with two sheet-metal shields (2Z), which hide all that rolls.

    `land` is the thickness of the rings at their faces.
    """
    inner, outer, recess, overlap = bore / 2 + land, outside / 2 - land, 0.06 * width, 0.1
    crimp, seam = 0.2 * (outer - inner), 3 * recess  # the seam beside the inner ring
    lower = [
        (inner - overlap, seam),
        (inner + overlap, seam),
        (inner + overlap, recess),
        (outer - 2 * crimp, recess),
        (outer - crimp, 2 * recess),
        (outer + overlap, 2 * recess),
    ]
    sections = [half_section(bore, 2 * inner, 0, width, recess)]
    sections.append(half_section(2 * outer, outside, 0, width, recess))
    return Assembly(
        {
            "bright steel": MeshBoolean(join=[spun(half) for half in sections], cut=[]),
            "zinc": turned(lower + [(radius, width - z) for radius, z in reversed(lower)]),
        }
    )


def thrust_ball_bearing(
    bore: float, outside: float, height: float, ball: float, balls: int
) -> Assembly:
    """Single direction: a housing washer below, a shaft washer above, a flat cage between."""
    pitch, groove, play, corner = (bore + outside) / 2, 0.54 * ball, 0.5, 0.06 * height
    washer = height / 2 - 0.3 * ball
    sunk = groove - (0.5 + PLAY) * ball
    housing = half_section(bore + 2 * play, outside, 0, washer, corner)
    housing -= Pos(pitch / 2, height / 2 + sunk) * Circle(groove)
    shaft = half_section(bore, outside - 2 * play, height - washer, height, corner)
    shaft -= Pos(pitch / 2, height / 2 - sunk) * Circle(groove)
    cage = half_section(
        pitch - 1.15 * ball, pitch + 1.15 * ball, height / 2 - 0.18 * ball, height / 2 + 0.18 * ball
    )
    rolling = copies_on_circle(balls, Pos(pitch / 2, 0, height / 2) * Sphere(ball / 2))
    return assembled([spun(housing), spun(shaft)], rolling, spun(cage))


RECIPES = [
    Recipe(
        "bearing-angular-7304",
        "ISO 15 7304 20x52x15",
        "build123d",
        ball_bearing,
        {"bore": 20.0, "outside": 52.0, "width": 15.0, "ball": 9.5, "balls": 10, "open_side": 0.17},
    ),
    Recipe(
        "bearing-deep-groove-6300",
        "ISO 15 6300 10x35x11",
        "build123d",
        ball_bearing,
        {"bore": 10.0, "outside": 35.0, "width": 11.0, "ball": 7.0, "balls": 7, "open_side": 0.0},
    ),
    Recipe(
        "bearing-shielded-608-2z",
        "ISO 15 608-2Z 8x22x7",
        "build123d",
        shielded_bearing,
        {"bore": 8.0, "outside": 22.0, "width": 7.0, "land": 1.9},
    ),
    Recipe(
        "bearing-thrust-51104",
        "ISO 104 51104 20x35x10",
        "build123d",
        thrust_ball_bearing,
        {"bore": 20.0, "outside": 35.0, "height": 10.0, "ball": 5.556, "balls": 12},
    ),
]
