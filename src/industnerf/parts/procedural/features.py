"""What machining and casting add to a body: bores, pockets, slots, fins, bosses, threads.

Tools are drawn at the origin with +z out of the material, so that `primitives.facing` puts them on
any side; the surface is z = 0, and a tool reaches a little above it.
"""

import numpy as np
from manifold3d import CrossSection, Manifold

from industnerf.parts.procedural.primitives import SIDES, cylinder, facing, prism, turned, union
from industnerf.parts.procedural.profiles import (
    angles,
    circle,
    cutout,
    offset,
    polygon,
    scatter,
)
from industnerf.parts.procedural.sampler import Real, Sampler, cosine, on_grid, sine

ABOVE = 0.02  # how far a tool starts above the surface
THREAD_CORNERS = {1: 24, 2: 16, 3: 12, 4: 12}  # of a thread's profile, by number of starts


class EmptyBody(Exception):
    """Cuts have left nothing: the draw is refused."""


def bore_tool(rng: Sampler, radius: Real, depth: Real) -> Manifold:
    """A plain, chamfered, countersunk or counterbored hole, its end flat or a drill's cone."""
    tip = 0.58 * radius if rng.chance(0.5) else 0.0  # of a drill of 120 degrees
    head, mouth = rng.uniform(1.3, 2.0) * radius, rng.uniform(0.15, 0.5) * depth
    outside = {
        "plain": [(radius, ABOVE)],
        "chamfered": [(1.2 * radius, ABOVE), (1.2 * radius, 0), (radius, -0.2 * radius)],
        "countersunk": [(head, ABOVE), (head, 0), (radius, radius - head)],
        "counterbored": [(head, ABOVE), (head, -mouth), (radius, -mouth)],
    }[rng.pick(("plain", "plain", "chamfered", "countersunk", "counterbored"))]
    return turned(polygon([(0, ABOVE), *outside, (radius, -depth), (0, -depth - tip)]))


def pocket_tool(section: CrossSection, depth: Real) -> Manifold:
    return prism(section, -depth, ABOVE)


def extents(body: Manifold) -> tuple[np.ndarray, np.ndarray]:
    """The lower and the upper corner of the bounding box; raises EmptyBody if there is none."""
    if body.is_empty():
        raise EmptyBody
    box = np.array(body.bounding_box())
    return box[:3], box[3:]


def drilled(rng: Sampler, body: Manifold, count: int, largest: Real) -> Manifold:
    """`body` with `count` bores along the axes, entering wherever its box says."""
    low, high = extents(body)
    tools = []
    for _ in range(count):
        side = rng.pick(SIDES)
        axis = "xyz".index(side[1])
        across = [i for i in range(3) if i != axis]
        at = (low + high) / 2
        at[across] = low[across] + rng.uniforms(0.2, 0.8, 2) * (high - low)[across]
        at[axis] = high[axis] if side[0] == "+" else low[axis]
        length = (high - low)[axis]
        depth = length + 1 if rng.chance(0.5) else rng.uniform(0.3, 0.8) * length
        radius = rng.uniform(0.3, 1.0) * largest
        tools.append(facing(side, bore_tool(rng, radius, depth), on_grid(at).tolist()))
    return body - union(tools)


def cut_top(rng: Sampler, section: CrossSection, height: Real, count: int) -> list[Manifold]:
    """Tools for bores and pockets of several depths in the top (z = `height`) of a prism."""
    left, bottom, right, top = section.bounds()
    small = min(right - left, top - bottom)
    tools = []
    for x, y, radius in scatter(rng, section, count, 0.05 * small, 0.22 * small, 0.02 * small):
        depth = height + 1 if rng.chance(0.45) else rng.uniform(0.25, 0.85) * height
        if rng.chance(0.5):
            tool = bore_tool(rng, 0.5 * radius, depth)
        else:
            tool = pocket_tool(cutout(rng, 2 * radius), depth)
        tools.append(tool.translate([x, y, height]))
    return tools


def bosses(rng: Sampler, section: CrossSection, base: Real, count: int) -> Manifold:
    """Cylinders and cones on a surface at z = `base`, within `section`, many of them bored."""
    left, bottom, right, top = section.bounds()
    small = min(right - left, top - bottom)
    parts = []
    for x, y, radius in scatter(rng, section, count, 0.06 * small, 0.25 * small, 0.01 * small):
        height = rng.uniform(0.3, 3.0) * radius + 0.05 * small
        taper = radius if rng.chance(0.7) else rng.uniform(0.5, 1.0) * radius
        boss = cylinder(radius, height, (x, y, base + height / 2 - ABOVE), taper)
        if rng.chance(0.6):
            hole = bore_tool(rng, rng.uniform(0.3, 0.6) * taper, rng.uniform(0.4, 0.95) * height)
            boss -= hole.translate([x, y, base + height - ABOVE])
        parts.append(boss)
    return union(parts)


def ribs(rng: Sampler, section: CrossSection, base: Real, height: Real, count: int) -> Manifold:
    """Thin walls at several angles on a surface at z = `base`, ending with `section`."""
    left, bottom, right, top = section.bounds()
    reach, small = right - left + top - bottom, min(right - left, top - bottom)
    step = rng.pick((90.0, 60.0, 45.0, 30.0))
    walls = []
    for _ in range(count):
        center = rng.uniform(left, right) * 0.8, rng.uniform(bottom, top) * 0.8
        thickness = rng.uniform(0.02, 0.07) * small
        strip = CrossSection.square([reach, thickness], True).rotate(step * rng.integer(0, 5))
        walls.append(prism((strip.translate(center)) ^ section, base - ABOVE, base + height))
    return union(walls)


def threaded_rod(
    radius: Real, depth: Real, length: Real, turns: int, starts: int, is_round: bool
) -> Manifold:
    """A right-handed thread between z = 0 and `length`.

    It is a section whose radius falls and rises by `depth`, `starts` times in a turn, extruded
    with twist.  Each layer is turned by one corner, so that its triangles follow the helix.
    """
    per_start = THREAD_CORNERS[starts]
    corners = per_start * starts
    turn, phase = angles(corners), np.arange(corners) % per_start / per_start
    wave = (1 - cosine(2 * np.pi * phase)) / 2 if is_round else 1 - np.abs(2 * phase - 1)
    reach = radius - depth + depth * wave
    section = polygon(reach[:, None] * np.stack([cosine(turn), sine(turn)], axis=1))
    return section.extrude(length, corners * turns - 1, 360.0 * turns)


def inset(section: CrossSection, distance: Real) -> CrossSection:
    """The section shrunk, or itself where nothing would be left."""
    smaller = offset(section, -distance)
    return section if smaller.is_empty() else smaller


def ring(outer: Real, inner: Real) -> CrossSection:
    return circle(outer) - circle(inner)
