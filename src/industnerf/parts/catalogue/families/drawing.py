"""Turned, milled and drilled bodies, so that a family reads like a workshop drawing.

Lengths are in mm, angles in degrees.  Bodies stand on the plane z = `at[2]` and are centered on
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
    FilletPolyline,
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
    trace,
)

Real = float | int  # drawings write 0 for 0.0, and the type checker of the tests is strict
Point = tuple[Real, Real]
Position = tuple[Real, Real, Real]

STANDING = (Align.CENTER, Align.CENTER, Align.MIN)
ORIGIN: Position = (0, 0, 0)
PRESS = 0.1  # of one body drawn into another, so that they unite as meshes


def rod(diameter: Real, height: Real, at: Position = ORIGIN) -> Shape:
    """A round bar along +z."""
    return Pos(*at) * Cylinder(diameter / 2, height, align=STANDING)


def bar(diameter: Real, length: Real, axis: str, center: Position = ORIGIN) -> Shape:
    """A round bar along `axis`, "x" or "y", centered on `center`."""
    turn = {"x": Rot(0, 90, 0), "y": Rot(90, 0, 0)}[axis]
    return Pos(*center) * turn * Cylinder(diameter / 2, length)


def block(x: Real, y: Real, z: Real, at: Position = ORIGIN) -> Shape:
    return Pos(*at) * Box(x, y, z, align=STANDING)


def rounded_block(x: Real, y: Real, z: Real, radius: Real, at: Position = ORIGIN) -> Shape:
    """A block whose four upright edges are rounded."""
    return Pos(*at) * extrude(RectangleRounded(x, y, radius), z)


def hexagon(across_flats: Real, height: Real, at: Position = ORIGIN) -> Shape:
    """A hexagonal bar, a corner pointing along +x."""
    return Pos(*at) * extrude(RegularPolygon(across_flats / math.sqrt(3), 6), height)


def slot(length: Real, width: Real, height: Real, at: Position = ORIGIN) -> Shape:
    """A bar with round ends along x; `length` is overall."""
    return Pos(*at) * extrude(SlotOverall(length, width), height)


def polygon(points: Sequence[Point]) -> Sketch:
    return make_face(Polyline(*points, close=True))


def turned(profile: Sequence[Point]) -> Shape:
    """What a lathe makes of a closed polygon of (radius, z)."""
    return revolve(Plane.XZ * polygon(profile), axis=Axis.Z)


def upright(profile: Sequence[Point], width: Real, center_y: Real = 0.0) -> Shape:
    """A plate of `width` along y whose outline is a closed polygon of (x, z)."""
    return Pos(0, center_y, 0) * extrude(Plane.XZ * polygon(profile), width / 2, both=True)


def tangent_hull(center: Point, radius: Real, other_center: Point, other_radius: Real) -> Sketch:
    """Two circles and their outer tangents."""
    one, other = Pos(*center) * Circle(radius), Pos(*other_center) * Circle(other_radius)
    return make_hull(one.edges() + other.edges())


def on_circle(count: int, diameter: Real, start: Real = 0.0) -> list[Point]:
    """`count` points evenly on a pitch circle, the first at `start` degrees from +x."""
    angles = (math.radians(start + 360 * i / count) for i in range(count))
    return [(diameter / 2 * math.cos(a), diameter / 2 * math.sin(a)) for a in angles]


def on_grid(x: Real, y: Real) -> list[Point]:
    """The four corners of a bolt pattern `x` by `y`."""
    return [(sx * x / 2, sy * y / 2) for sx in (1, -1) for sy in (1, -1)]


def copies_on_circle(count: int, body: Shape, start: Real = 0.0) -> list[Shape]:
    """`count` copies of `body` evenly about the z axis."""
    return [Rot(0, 0, start + 360 * i / count) * body for i in range(count)]


def rods(points: Iterable[Point], diameter: Real, height: Real, base: Real = 0.0) -> list[Shape]:
    """Equal rods, or drills, on the points of a pattern."""
    return [rod(diameter, height, (x, y, base)) for x, y in points]


def hub_keyway(bore: Real, width: Real, depth: Real, height: Real, base: Real = 0.0) -> Shape:
    """What a broach takes out of a hub at +x: `depth` beyond the bore, `width` along y."""
    return block(bore / 2 + depth, width, height, ((bore / 2 + depth) / 2, 0, base))


def threaded(diameter: Real, pitch: Real, height: Real, at: Position = ORIGIN) -> Shape:
    """A rod with the look of a thread: rings of the ISO 68-1 profile in place of its helix."""
    crest, root = diameter / 2, diameter / 2 - 0.6134 * pitch
    ring = [(root, 0.125), (crest, 0.4375), (crest, 0.5625), (root, 0.875)]  # z in pitches
    turns = range(int(height / pitch))
    profile = [(radius, (turn + z) * pitch) for turn in turns for radius, z in ring]
    return Pos(*at) * turned([(0, 0), (root, 0), *profile, (root, height), (0, height)])


def bent_sheet(middle: Sequence[Point], thickness: Real, bend: Real, width: Real) -> Shape:
    """A sheet of `width` along y, its middle line through points of (x, z), bent at `bend`."""
    line = FilletPolyline(*middle, radius=bend)
    return extrude(Plane.XZ * trace(line, thickness), width / 2, both=True)


def faced_hexagon(across_flats: Real, height: Real, at: Position = ORIGIN) -> Shape:
    """A hexagonal bar whose corners are turned down at 30 degrees at both ends, like a nut's."""
    corner, face = across_flats / math.sqrt(3), 0.475 * across_flats  # radii
    drop = (corner - face) * math.tan(math.radians(30))
    middle = [(corner, drop), (corner, height - drop)]
    envelope = turned([(0, 0), (face, 0), *middle, (face, height), (0, height)])
    return Pos(*at) * (hexagon(across_flats, height) & envelope)


def raised_flange(
    diameter: Real, plate: Real, bolt_circle: Real, bolts: int, bolt_hole: Real
) -> Shape:
    """A pipe flange, not yet bored: its raised face on z = 0, no bolt hole on the x axis."""
    raised, step = 0.65 * diameter, 3.0
    flange = rod(diameter, plate - step, (0, 0, step)) + rod(raised, plate)
    return flange - rods(on_circle(bolts, bolt_circle, 180 / bolts), bolt_hole, plate)


def keyed_bore(
    bore: Real, key: Real, height: Real, base: Real = 0.0, depth: Real | None = None
) -> list[Shape]:
    """The drill and the broach of a hub; the keyway lies at +x, by default 0.45 `key` deep."""
    depth = 0.45 * key if depth is None else depth
    return [rod(bore, height, (0, 0, base)), hub_keyway(bore, key, depth, height, base)]


def tube(outer: Real, inner: Real, height: Real, at: Position = ORIGIN) -> Shape:
    """A round pipe along +z, or what an annular recess takes out of a disc."""
    return rod(outer, height, at) - rod(inner, height, at)


def chamfered_rod(diameter: Real, height: Real, chamfer: Real, at: Position = ORIGIN) -> Shape:
    """A round bar along +z whose two rims are broken at 45 degrees."""
    radius, small = diameter / 2, diameter / 2 - chamfer
    outline = [(0, 0), (small, 0), (radius, chamfer)]
    outline += [(radius, height - chamfer), (small, height), (0, height)]
    return Pos(*at) * turned(outline)


def round_section(diameter: Real, sides: int = 16) -> Sketch:
    """A polygon that encloses the area of a circle, to be swept along a curve.

    The swept body takes a quarter of the triangles, and keeps within the meshes' tolerance.
    """
    stretch = math.sqrt(2 * math.pi / (sides * math.sin(2 * math.pi / sides)))
    return RegularPolygon(diameter / 2 * stretch, sides)


def half_section(inner: Real, outer: Real, low: Real, high: Real, corner: Real = 0) -> Sketch:
    """Of a ring between two diameters and two heights: its right half, `corner`s at 45 degrees."""
    a, b, c = inner / 2, outer / 2, corner
    below = [(a, low + c), (a + c, low), (b - c, low), (b, low + c)]
    above = [(radius, low + high - z) for radius, z in reversed(below)]
    return polygon(below + above if corner else [(a, low), (b, low), (b, high), (a, high)])


def spun(half: Sketch) -> Shape:
    """The ring of which this is half a section, drawn in radius and height."""
    return revolve(Plane.XZ * half, Axis.Z)


def mirrored(upper: Sequence[Point]) -> list[Point]:
    """A closed profile of (radius, z): `upper`, and its image below z = 0."""
    return [*upper, *((radius, -z) for radius, z in reversed(upper))]


def fused(bodies: Sequence[Shape]) -> Shape:
    """One shape of several that may overlap, touch or lie apart."""
    first, *others = bodies
    return first + others
