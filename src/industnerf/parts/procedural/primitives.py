"""Bodies that others are made of: blocks, cylinders, prisms with eased edges, turned and swept."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float
from manifold3d import CrossSection, Manifold, OpType

from industnerf.parts.procedural.profiles import SEGMENTS, Points2, offset, polygon
from industnerf.parts.procedural.sampler import Real, cosine, on_grid, sine

Vector = Sequence[Real]
Path3 = Float[np.ndarray, "n 3"]
ORIGIN = (0.0, 0.0, 0.0)
TURNS = {  # degrees about x, y and z that take +z to a side of the box
    "+z": (0, 0, 0),
    "-z": (180, 0, 0),
    "+x": (0, 90, 0),
    "-x": (0, -90, 0),
    "+y": (-90, 0, 0),
    "-y": (90, 0, 0),
}
SIDES = tuple(TURNS)


def block(size: Vector, center: Vector = ORIGIN) -> Manifold:
    return Manifold.cube(list(size), True).translate(list(center))


def cylinder(
    radius: Real,
    height: Real,
    center: Vector = ORIGIN,
    top_radius: Real | None = None,
    segments: int = SEGMENTS,
) -> Manifold:
    """Along z; a cone where `top_radius` differs."""
    top = radius if top_radius is None else top_radius
    return Manifold.cylinder(height, radius, top, segments, True).translate(list(center))


def prism(section: CrossSection, bottom: Real, top: Real) -> Manifold:
    """The section from z = `bottom` to `top`."""
    return section.extrude(top - bottom).translate([0, 0, bottom])


def eased_prism(section: CrossSection, bottom: Real, top: Real, ease: Real, steps: int) -> Manifold:
    """A prism of a convex section whose end edges are chamfered (1 step) or rounded (more)."""
    turn = np.linspace(0, np.pi / 2, steps + 1)
    insets, depths = ease * (1 - sine(turn)), ease * (1 - cosine(turn))
    layers = []
    for inset, depth in on_grid(np.stack([insets, depths], axis=1)).tolist():
        layer = offset(section, -inset, is_round=False) if inset > 0 else section
        if not layer.is_empty():  # the inset may be more than a thin section has
            layers.append(prism(layer, bottom + depth, top - depth))
    return Manifold.batch_hull(layers)


def rounded_block(size: Vector, radius: Real) -> Manifold:
    """A block with all edges and corners round."""
    half = [max(edge / 2 - radius, 1e-3) for edge in size]
    ball = Manifold.sphere(radius, 16)
    corners = [
        ball.translate([x * half[0], y * half[1], z * half[2]])
        for x in (-1, 1)
        for y in (-1, 1)
        for z in (-1, 1)
    ]
    return Manifold.batch_hull(corners)


def turned(section: CrossSection, degrees: Real = 360.0) -> Manifold:
    """The part of the section at x > 0 revolved about its y axis, which becomes z."""
    return section.revolve(SEGMENTS, degrees)


def turned_outline(points: Points2) -> CrossSection:
    """A section for `turned` from (radius, z) points along the outside: closed on the axis.

    It is mirrored, so that fillets round no corner on the axis.
    """
    return polygon(np.concatenate([points, points[::-1] * [-1, 1]]))


def facing(side: str, body: Manifold, at: Vector = ORIGIN) -> Manifold:
    """`body`, drawn with +z outward, turned to look towards a side such as "-x", then moved."""
    return body.rotate(list(TURNS[side])).translate(list(at))


def union(bodies: Sequence[Manifold]) -> Manifold:
    return Manifold.batch_boolean(list(bodies), OpType.Add)


def strut(start: Vector, end: Vector, radius: Real, segments: int) -> Manifold:
    """A round or prismatic bar between two points, with balls (or their kin) for ends."""
    ball = Manifold.sphere(radius, segments)
    return Manifold.batch_hull([ball.translate(list(start)), ball.translate(list(end))])


def swept(section: CrossSection, path: Path3) -> Manifold:
    """The section carried along `path` without twist, square to it; ends are flat.

    The section may have holes.  It must be smaller than the path's radius of curvature.
    """
    steps = len(path) - 1
    tangents = np.gradient(path, axis=0)
    tangents /= np.linalg.norm(tangents, axis=1, keepdims=True)
    rights, ups = _carried_frame(tangents)

    def onto_path(points: Path3) -> Path3:
        i = np.round(points[:, 2] * steps).astype(int)
        return on_grid(path[i] + points[:, :1] * rights[i] + points[:, 1:2] * ups[i])

    return section.extrude(1.0, steps - 1).warp_batch(onto_path)


def _carried_frame(tangents: Path3) -> tuple[Path3, Path3]:
    """Two unit vectors across each tangent, carried along without twist."""
    axis = np.eye(3)[np.argmin(np.abs(tangents[0]))]
    right = np.cross(axis, tangents[0])
    rights = []
    for tangent in tangents:
        right = right - (right @ tangent) * tangent
        right /= np.linalg.norm(right)
        rights.append(right)
    return np.array(rights), np.cross(tangents, rights)


def smooth_path(knots: Float[np.ndarray, "knots 3"], steps: int) -> Float[np.ndarray, "n 3"]:
    """A curve through the knots, `steps` points between two -- Catmull and Rom (1974)."""
    padded = np.concatenate([2 * knots[:1] - knots[1:2], knots, 2 * knots[-1:] - knots[-2:-1]])
    t = np.arange(steps)[:, None] / steps
    pieces = []
    for a, b, c, d in zip(padded, padded[1:], padded[2:], padded[3:], strict=False):
        slope_in, slope_out = (c - a) / 2, (d - b) / 2
        cubic = 2 * (b - c) + slope_in + slope_out
        square = 3 * (c - b) - 2 * slope_in - slope_out
        pieces.append(((cubic * t + square) * t + slope_in) * t + b)
    return np.concatenate([*pieces, knots[-1:]])
