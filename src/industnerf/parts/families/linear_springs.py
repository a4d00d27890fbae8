"""Linear motion and springs."""

import math

from build123d import Circle, Edge, Plane, Pos, Shape, Wire, sweep

from industnerf.parts.families.drawing import bar, block, on_circle, rod, rods, turned
from industnerf.parts.recipe import MeshBoolean, Recipe


def helix_rod(diameter: float, pitch: float, height: float, radius: float) -> Shape:
    """A round wire of `diameter` wound about z at `radius`, rising from z = 0."""
    path = Wire([Edge.make_helix(pitch, height, radius)])
    return sweep(Plane(origin=path @ 0, z_dir=path % 0) * Circle(diameter / 2), path=path)


def ball_screw_nut(
    screw: float,
    lead: float,
    ball: float,
    body: float,
    flange: float,
    bolt_circle: float,
    flats: float,
    length: float,
) -> MeshBoolean:
    """Flanged nut, DIN 69051-5 form B: two flats, six bolts, the ball track cut in its bore."""
    plate, relief, groove = 10.0, 0.5, 1.03 * ball
    nut = turned(
        [
            (0, 0),
            (flange / 2 - 0.5, 0),
            (flange / 2, 0.5),
            (flange / 2, plate - 0.5),
            (flange / 2 - 0.5, plate),
            (body / 2 - relief, plate),
            (body / 2 - relief, plate + 3),
            (body / 2, plate + 3),
            (body / 2, length - 1),
            (body / 2 - 1, length),
            (0, length),
        ]
    )
    nut -= [block(flange, flange, plate, (0, s * (flats + flange) / 2, 0)) for s in (1, -1)]
    bolts = [p for p in on_circle(8, bolt_circle, 0) if abs(p[0]) > 1]
    nut -= rods(bolts, 5.5, plate)
    nut -= bar(5.0, flange, "y", (0, (flange + body) / 2 - 6, plate / 2))  # oil hole
    nut -= rod(screw + 0.6, length)
    wiper = screw + 4.0
    nut -= rod(wiper, 3.5) + rod(wiper, 3.5, (0, 0, length - 3.5))
    track_radius = (screw + 0.4 * ball) / 2
    track = Pos(0, 0, 6) * helix_rod(groove, lead, length - 12, track_radius)
    return MeshBoolean(join=[nut], cut=[track])


RECIPES = [
    Recipe(
        "ballscrew-nut-sfu1605",
        "DIN 69051-5 form B 16x5 (SFU1605)-like",
        "build123d",
        ball_screw_nut,
        {
            "screw": 16,
            "lead": 5,
            "ball": 3.175,
            "body": 28,
            "flange": 48,
            "bolt_circle": 38,
            "flats": 40,
            "length": 50,
        },
    ),
]
