"""Linear motion and springs."""

import numpy as np
from build123d import Edge, Line, Plane, Pos, Shape, Spline, Wire, sweep

from industnerf.parts.catalogue.families import linear_guides
from industnerf.parts.catalogue.families.drawing import (
    Real,
    bar,
    block,
    on_circle,
    rod,
    rods,
    round_section,
    turned,
)
from industnerf.parts.catalogue.recipe import MeshBoolean, Recipe


def helix_rod(diameter: float, pitch: float, height: float, radius: float) -> Shape:
    """A round wire of `diameter` wound about z at `radius`, rising from z = 0."""
    path = Wire([Edge.make_helix(pitch, height, radius)])
    section = Plane(origin=path @ 0, z_dir=path % 0) * round_section(diameter)
    return sweep(section, path=path, is_frenet=True)


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
    plate, undercut, groove = 10.0, 0.5, 1.03 * ball
    nut = turned(
        [
            (0, 0),
            (flange / 2 - 0.5, 0),
            (flange / 2, 0.5),
            (flange / 2, plate - 0.5),
            (flange / 2 - 0.5, plate),
            (body / 2 - undercut, plate),
            (body / 2 - undercut, plate + 3),
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


def compression_spring(wire: float, mean: float, active: float, pitch: float) -> MeshBoolean:
    """Cylindrical spring of EN 15800: closed and ground ends, 1 1/4 dead coils at each.

    `mean` is the coils' mean diameter, `active` their number, `pitch` the rise of one of them.
    The ground ends lie at z = 0 and above.
    """
    closed = 1.04 * wire  # pitch of the end coils: all but touching
    dead, ramp, steps = 1.25, 0.5, 12  # turns, turns, points per turn
    turns = active + 2 * dead
    count = round(turns * steps)
    turn = np.linspace(0, turns, count + 1)
    inside = np.minimum(turn, turns - turn)  # turns from the nearer end
    opening = np.clip((inside - dead + ramp / 2) / ramp, 0, 1)
    slope = closed + (pitch - closed) * opening**2 * (3 - 2 * opening)
    rise = np.concatenate([[0.0], np.cumsum((slope[1:] + slope[:-1]) / 2 * np.diff(turn))])
    z = rise - wire / 4  # the tip is ground to a quarter of the wire
    top = rise[-1] - wire / 2
    angle = 2 * np.pi * turn
    path = Spline(*zip(mean / 2 * np.cos(angle), mean / 2 * np.sin(angle), z, strict=True))
    coil = sweep(Plane(path @ 0, z_dir=path % 0) * round_section(wire), path=path, is_frenet=True)
    far = 2 * mean
    return MeshBoolean(
        join=[coil], cut=[block(far, far, wire, (0, 0, -wire)), block(far, far, wire, (0, 0, top))]
    )


def torsion_spring(wire: Real, mean: Real, coils: Real, leg: Real) -> Shape:
    """Close-coiled torsion spring about z with straight tangential legs, after EN 13906-3."""
    pitch = 1.06 * wire
    helix = Edge.make_helix(pitch, coils * pitch, mean / 2)
    start, end = helix @ 0 - leg * (helix % 0), helix @ 1 + leg * (helix % 1)
    path = Wire([Line(start, helix @ 0).edge(), helix, Line(helix @ 1, end).edge()])
    section = Plane(origin=start, x_dir=(0, 0, 1), z_dir=helix % 0) * round_section(wire)
    return sweep(section, path=path, is_frenet=True)


RECIPES = [
    Recipe(
        "ballscrew-nut-sfu1605",
        "DIN 69051-5 form B 16x5 (SFU1605)-like",
        "build123d",
        ball_screw_nut,
        {
            "screw": 16.0,
            "lead": 5.0,
            "ball": 3.175,
            "body": 28.0,
            "flange": 48.0,
            "bolt_circle": 38.0,
            "flats": 40.0,
            "length": 50.0,
        },
        finish="bright steel",
    ),
    Recipe(
        "spring-compression-3-2x20",
        "EN 15800-like compression spring 3.2x20, 8.5 active coils",
        "build123d",
        compression_spring,
        {"wire": 3.2, "mean": 20.0, "active": 8.5, "pitch": 7.0},
    ),
    Recipe(
        "spring-torsion-2-5x20",
        "EN 13906-3-like torsion spring 2.5x20, 5.25 coils",
        "build123d",
        torsion_spring,
        {"wire": 2.5, "mean": 20.0, "coils": 5.25, "leg": 32.0},
    ),
    *linear_guides.RECIPES,
]
