"""Turned, milled and drilled bodies, so that a family reads like a workshop drawing.

Lengths are in mm, angles in degrees.  Bodies stand on the plane z = `at[2]` and are centred on
`at` in x and y, unless they say otherwise.
"""

import math
from collections.abc import Iterable, Sequence

from build123d import (
    Align,
    Axis,
    Box,
    Circle,
    Cylinder,
    Plane,
    Polyline,
    Pos,
    RectangleRounded,
    RegularPolygon,
    Rot,
    Shape,
    Sketch,
    SlotOverall,
    extrude,
    make_face,
    make_hull,
    revolve,
)

Real = float | int  # drawings write 0 for 0.0, and the type checker of the tests is strict
Point = tuple[Real, Real]
Place = tuple[Real, Real, Real]

STANDING = (Align.CENTER, Align.CENTER, Align.MIN)
ORIGIN: Place = (0, 0, 0)


def rod(diameter: Real, height: Real, at: Place = ORIGIN) -> Shape:
    """A round bar along +z."""
    return Pos(*at) * Cylinder(diameter / 2, height, align=STANDING)


def bar(diameter: Real, length: Real, axis: str, centre: Place = ORIGIN) -> Shape:
    """A round bar along `axis`, "x" or "y", centred on `centre`."""
    turn = {"x": Rot(0, 90, 0), "y": Rot(90, 0, 0)}[axis]
    return Pos(*centre) * turn * Cylinder(diameter / 2, length)


def block(x: Real, y: Real, z: Real, at: Place = ORIGIN) -> Shape:
    return Pos(*at) * Box(x, y, z, align=STANDING)


def rounded_block(x: Real, y: Real, z: Real, radius: Real, at: Place = ORIGIN) -> Shape:
    """A block whose four upright edges are rounded."""
    return Pos(*at) * extrude(RectangleRounded(x, y, radius), z)


def hexagon(across_flats: Real, height: Real, at: Place = ORIGIN) -> Shape:
    """A hexagonal bar, a corner pointing along +x."""
    return Pos(*at) * extrude(RegularPolygon(across_flats / math.sqrt(3), 6), height)


def slot(length: Real, width: Real, height: Real, at: Place = ORIGIN) -> Shape:
    """A bar with round ends along x; `length` is overall."""
    return Pos(*at) * extrude(SlotOverall(length, width), height)


def polygon(points: Sequence[Point]) -> Sketch:
    return make_face(Polyline(*points, close=True))


def turned(profile: Sequence[Point]) -> Shape:
    """What a lathe makes of a closed polygon of (radius, z)."""
    return revolve(Plane.XZ * polygon(profile), axis=Axis.Z)


def upright(profile: Sequence[Point], width: Real, centre_y: Real = 0.0) -> Shape:
    """A plate of `width` along y whose outline is a closed polygon of (x, z)."""
    return Pos(0, centre_y, 0) * extrude(Plane.XZ * polygon(profile), width / 2, both=True)


def tangent_hull(centre: Point, radius: Real, other_centre: Point, other_radius: Real) -> Sketch:
    """Two circles and their outer tangents."""
    one, other = Pos(*centre) * Circle(radius), Pos(*other_centre) * Circle(other_radius)
    return make_hull(one.edges() + other.edges())


def on_circle(count: int, diameter: Real, start: Real = 0.0) -> list[Point]:
    """`count` points evenly on a pitch circle, the first at `start` degrees from +x."""
    angles = (math.radians(start + 360 * i / count) for i in range(count))
    return [(diameter / 2 * math.cos(a), diameter / 2 * math.sin(a)) for a in angles]


def on_grid(x: Real, y: Real) -> list[Point]:
    """The four corners of a bolt pattern `x` by `y`."""
    return [(sx * x / 2, sy * y / 2) for sx in (1, -1) for sy in (1, -1)]


def around(count: int, body: Shape, start: Real = 0.0) -> list[Shape]:
    """`count` copies of `body` evenly about the z axis."""
    return [Rot(0, 0, start + 360 * i / count) * body for i in range(count)]


def rods(points: Iterable[Point], diameter: Real, height: Real, base: Real = 0.0) -> list[Shape]:
    """Equal rods, or drills, on the points of a pattern."""
    return [rod(diameter, height, (x, y, base)) for x, y in points]


def hub_keyway(bore: Real, width: Real, depth: Real, height: Real, base: Real = 0.0) -> Shape:
    """What a broach takes out of a hub at +x: `depth` beyond the bore, `width` along y."""
    return block(bore / 2 + depth, width, height, ((bore / 2 + depth) / 2, 0, base))
