"""Abstract kinds made of other bodies: random CSG trees, symmetry, hulls, cuts by planes."""

from itertools import pairwise

import numpy as np
from manifold3d import Manifold

from industnerf.parts.procedural.features import bore_tool, drilled, extents
from industnerf.parts.procedural.primitives import (
    SIDES,
    block,
    cylinder,
    facing,
    prism,
    rounded_block,
    turned,
    union,
)
from industnerf.parts.procedural.profiles import circle, irregular_polygon, outline
from industnerf.parts.procedural.sampler import Sampler

MIN_LEFT = 0.35  # of the volume, after one cut


def _primitive(rng: Sampler) -> Manifold:
    """A block, prism, cylinder, cone, ball or ring along one of the axes."""
    x, y, z = rng.box("block", "block", "slab", "beam")
    form = rng.pick(("block", "block", "cylinder", "cylinder", "cone", "prism", "ball", "ring"))
    if form == "block":
        body = block((x, y, z)) if rng.chance(0.7) else rounded_block((x, y, z), 0.2 * min(x, y, z))
    elif form == "cylinder":
        body = cylinder(y / 2, z)
    elif form == "cone":
        body = cylinder(y / 2, z, top_radius=rng.uniform(0.1, 0.9) * y / 2)
    elif form == "prism":
        body = prism(irregular_polygon(rng, rng.integer(3, 6), x, y), -z / 2, z / 2)
    elif form == "ball":
        body = Manifold.sphere(y / 2, 32)
    else:
        body = turned(circle(0.12, (0.12 + x / 3, 0), 20))
    return facing(rng.pick(SIDES), body)


def _grow(rng: Sampler, body: Manifold, steps: int, snap: int) -> Manifold:
    """`body` with primitives added or cut away at points of its box, on a grid of 1 / `snap`."""
    for _ in range(steps):
        low, high = extents(body)
        at = np.round(snap * (low + rng.uniforms(0.05, 0.95, 3) * (high - low))) / snap
        part = _primitive(rng).scale([rng.uniform(0.3, 0.9)] * 3).translate(at.tolist())
        if rng.chance(0.5):
            body += part
        elif (body - part).volume() > MIN_LEFT * body.volume():
            body -= part
    return body


def combined(rng: Sampler) -> Manifold:
    """A random tree of unions and differences of primitives."""
    return _grow(rng, _primitive(rng), rng.integer(3, 8), 8)


def mirrored(rng: Sampler) -> Manifold:
    """A random tree of primitives made symmetrical about one, two or three planes."""
    body = _grow(rng, _primitive(rng), rng.integer(2, 5), 8)
    low, high = extents(body)
    for axis in range(rng.integer(1, 3)):
        normal = np.eye(3)[axis].tolist()
        plane = float(low[axis] + rng.uniform(0.1, 0.5) * (high - low)[axis])
        half = body.trim_by_plane(normal, plane)
        body = half + half.translate([-plane * n for n in normal]).mirror(normal).translate(
            [plane * n for n in normal]
        )
    return body


def block_steps(rng: Sampler) -> Manifold:
    """Blocks added to and cut from a block, all on one grid: steps, channels and bridges."""
    x, y, z = rng.box("block", "slab")
    body = block((x, y, z))
    for _ in range(rng.integer(3, 9)):
        at = np.round(6 * rng.uniforms(-0.5, 0.5, 3) * [x, y, z]) / 6
        size = np.round(8 * rng.uniforms(0.15, 0.75, 3)) / 8 * [x, y, z]
        piece = block(size.tolist(), at.tolist())
        if rng.chance(0.3):
            body += piece
        elif (body - piece).volume() > MIN_LEFT * body.volume():
            body -= piece
    if rng.chance(0.5):
        body = drilled(rng, body, rng.integer(1, 3), 0.12 * min(x, y, z))
    return body


def polar_pattern(rng: Sampler) -> Manifold:
    """One random piece repeated round an axis, on a core, some of it cut away likewise."""
    n = rng.integer(2, 7)
    radius, height = rng.uniform(0.2, 0.5), rng.uniform(0.1, 0.9)
    core = prism(circle(radius, segments=rng.pick((40, 40, 4, 6))), -height / 2, height / 2)
    piece = _grow(rng, _primitive(rng), 2, 8).scale([rng.uniform(0.3, 0.7)] * 3)
    piece = piece.translate([rng.uniform(0.7, 1.2) * radius, 0, rng.uniform(-0.2, 0.2)])
    body = core + union([piece.rotate([0, 0, 360.0 * k / n]) for k in range(n)])
    if rng.chance(0.6):
        cut = _primitive(rng).scale([rng.uniform(0.1, 0.3)] * 3)
        cut = cut.translate([rng.uniform(0.5, 1.0) * radius, 0, height / 2])
        body -= union([cut.rotate([0, 0, 360.0 * (k + 0.5) / n]) for k in range(n)])
    if rng.chance(0.6):
        body -= cylinder(rng.uniform(0.2, 0.7) * radius, 4)
    return body


def faceted_block(rng: Sampler) -> Manifold:
    """A block or cylinder cut by slanted planes, bored square to some of the cuts."""
    x, y, z = rng.box("block", "block", "slab", "beam")
    body = block((x, y, z)) if rng.chance(0.6) else cylinder(y / 2, 1.5 * z)
    small, tools = min(x, y, z), []
    for _ in range(rng.integer(2, 6)):
        turn = [rng.uniform(20, 160), 0.0, rng.uniform(0, 360)]
        level = rng.uniform(0.3, 0.5) * small
        cut = block((6, 6, 3), (0, 0, level + 1.5)).rotate(turn)
        if (body - cut).volume() < MIN_LEFT * body.volume():
            continue
        body -= cut
        if rng.chance(0.8):
            depth = rng.uniform(0.3, 2.0) * small
            tool = bore_tool(rng, rng.uniform(0.06, 0.2) * small, depth)
            tools.append(tool.translate([0, 0, level]).rotate(turn))
    return body - union(tools)


def hulled_lumps(rng: Sampler) -> Manifold:
    """Balls, blocks and discs joined pairwise by their hulls, as castings are, then bored."""
    lumps = []
    for _ in range(rng.integer(3, 6)):
        at = (rng.uniforms(-1, 1, 3) * [0.8, 0.6, 0.4]).tolist()
        size = rng.uniform(0.08, 0.3)
        lump = {
            "ball": Manifold.sphere(size, 32),
            "block": block((2 * size, 2 * size, size)),
            "disc": cylinder(size, rng.uniform(0.3, 1.5) * size, segments=28),
        }[rng.pick(("ball", "block", "disc", "disc"))]
        lumps.append(facing(rng.pick(SIDES), lump, at))
    pairs = [
        Manifold.batch_hull([lump, lumps[rng.integer(0, i)]]) for i, lump in enumerate(lumps[1:])
    ]
    body = union(pairs)
    return drilled(rng, body, rng.integer(1, 4), 0.1)


def lofted_stack(rng: Sampler) -> Manifold:
    """Convex outlines at several heights joined by straight sides, then bored."""
    count = rng.integer(2, 4)
    level, layers = 0.0, []
    for _ in range(count + 1):
        section = outline(rng, rng.uniform(0.3, 1.2), rng.uniform(0.3, 1.2)).hull()
        shift = rng.uniform(-0.15, 0.15), rng.uniform(-0.15, 0.15)
        layers.append(prism(section.translate(shift), level, level + 0.03))
        level += rng.log_uniform(0.08, 0.8)
    body = union([Manifold.batch_hull(list(pair)) for pair in pairwise(layers)])
    return drilled(rng, body, rng.integer(1, 3), 0.15)
