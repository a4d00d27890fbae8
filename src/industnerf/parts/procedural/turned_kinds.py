"""Abstract kinds that are revolved: random profiles, then random cuts."""

import numpy as np
from manifold3d import Manifold

from industnerf.parts.procedural.features import bore_tool, drilled, extents, threaded_rod
from industnerf.parts.procedural.primitives import (
    block,
    cylinder,
    facing,
    prism,
    smooth_path,
    turned,
    turned_outline,
    union,
)
from industnerf.parts.procedural.profiles import (
    Points2,
    cutout,
    fillet,
    irregular_polygon,
    offset,
    on_circle,
    outline,
    polygon,
    rectangle,
)
from industnerf.parts.procedural.sampler import Sampler


def turned_steps(rng: Sampler) -> Manifold:
    """Coaxial discs and cones of any order, edges filleted, bored and flattened."""
    body = turned(fillet(turned_outline(_steps(rng)), 0.02, rng.uniform(0, 0.08)))
    return _cut(rng, body)


def _steps(rng: Sampler) -> Points2:
    count = rng.integer(2, 7)
    levels = np.cumsum(np.r_[0, rng.uniforms(0.1, 1.0, count)])
    levels *= rng.log_uniform(0.15, 4.0) / levels[-1]
    radii = rng.uniforms(0.25, 1.0, count)
    tapered = radii * np.where(rng.uniforms(0, 1, count) < 0.25, 0.7, 1.0)
    corners = [
        corner
        for low, high, start, end in zip(levels, levels[1:], radii, tapered, strict=False)
        for corner in ((start, low), (end, high))
    ]
    return np.array(corners)


def turned_curve(rng: Sampler) -> Manifold:
    """A smooth outline revolved between flat ends, bored and flattened."""
    body = turned(turned_outline(_curve(rng)))
    return _cut(rng, body)


def _curve(rng: Sampler) -> Points2:
    knots = rng.integer(3, 6)
    heights = np.linspace(0, rng.log_uniform(0.3, 3.5), knots)
    points = np.stack([rng.uniforms(0.3, 1.0, knots), heights, np.zeros(knots)], axis=1)
    return smooth_path(points, 8)[:, :2]


def _cut(rng: Sampler, body: Manifold) -> Manifold:
    """Some of: a central bore at either end, holes on a circle, flats, cross bores, a slot."""
    _, high = extents(body)
    radius, height = high[0], high[2]
    if rng.chance(0.5):
        depth = height + 1 if rng.chance(0.5) else rng.uniform(0.2, 0.8) * height
        tool = bore_tool(rng, rng.uniform(0.08, 0.22) * radius, depth)
        body -= facing(rng.pick(("+z", "-z")), tool, (0, 0, height / 2)).translate(
            [0, 0, 0 if depth > height else rng.sign() * height / 2]
        )
    if rng.chance(0.35):
        n, size = rng.integer(2, 7), rng.uniform(0.05, 0.12) * radius
        tool = bore_tool(rng, size, rng.uniform(0.3, 1.2) * height)
        reach = rng.uniform(0.5, 0.85) * radius
        body -= union([tool.translate([x, y, height]) for x, y in on_circle(n, reach)])
    if rng.chance(0.35):
        n, inset = rng.integer(1, 4), rng.uniform(0.6, 0.9) * radius
        level = rng.uniform(-0.3, 1.0) * height
        flat = block((2, 4, height), (inset + 1, 0, level + height / 2))
        body -= union([flat.rotate([0, 0, 90.0 * k]) for k in range(n)])
    if rng.chance(0.3):
        body = drilled(rng, body, rng.integer(1, 3), 0.15 * min(2 * radius, height))
    if rng.chance(0.25):
        width = rng.uniform(0.05, 0.3) * radius
        slit = block((4, width, height), (0, 0, height * rng.uniform(1.0, 1.4)))
        body -= slit.rotate([0, 0, 15.0 * rng.integer(0, 11)])
    return body


def turned_shell(rng: Sampler) -> Manifold:
    """A thin wall of revolution, open or with a floor, with windows."""
    outline = _curve(rng)
    solid = turned_outline(outline)
    thickness = rng.uniform(0.02, 0.09)
    floor = thickness if rng.chance(0.6) else -1
    height = outline[-1, 1]
    cavity = offset(solid, -thickness) + (rectangle(0.4, 0.4, (0, height)))
    wide = offset(solid, -thickness).translate((0, rng.uniform(0.3, 1.0) * thickness * 3))
    inner = (cavity + wide) - rectangle(9, 2, (0, floor - 1))
    if floor < 0:
        inner = inner + rectangle(0.4, 0.4)
    body = turned(solid - inner)
    if rng.chance(0.6):
        n = rng.integer(1, 8)
        window = cutout(rng, min(0.5 * height, 2.2 / n)).extrude(3).rotate([0, 90, 0])
        window = window.translate([0, 0, rng.uniform(0.35, 0.65) * height])
        body -= union([window.rotate([0, 0, 360.0 * k / n]) for k in range(n)])
    return body


def turned_ring(rng: Sampler) -> Manifold:
    """A random section carried round the axis at a distance, notched or drilled."""
    size = rng.uniform(0.15, 0.6), rng.uniform(0.15, 0.9)
    section = irregular_polygon(rng, rng.integer(3, 8), *size)
    section = fillet(section, rng.uniform(0, 0.04))
    left, bottom, right, top = section.bounds()
    body = turned(section.translate((1 - right, -bottom)))
    n, form = rng.integer(1, 9), rng.pick(("notches", "holes", "windows", "none"))
    if form == "notches":
        depth = rng.uniform(0.2, 0.8) * (top - bottom)
        tool = block((2, rng.uniform(0.3, 1.5) / n, 2), (1.2, 0, depth + 1))
    elif form == "holes":
        tool = cylinder(rng.uniform(0.1, 0.3) * (right - left), 5, (1 - (right - left) / 2, 0, 0))
    elif form == "windows":
        hole = cutout(rng, min(0.6 * (top - bottom), 2.0 / n))
        tool = hole.extrude(3).rotate([0, 90, 0]).translate([0, 0, (top - bottom) / 2])
    if form == "none" or body.is_empty():  # a fillet can leave nothing of a thin section
        return body
    return body - union([tool.rotate([0, 0, 360.0 * k / n]) for k in range(n)])


def turned_sector(rng: Sampler) -> Manifold:
    """A random section turned through part of a circle, with bores."""
    size = rng.uniform(0.3, 1.0), rng.uniform(0.2, 1.2)
    section = fillet(irregular_polygon(rng, rng.integer(4, 8), *size), 0.03, 0.03)
    left, bottom, _, _ = section.bounds()
    body = turned(section.translate((rng.uniform(0, 0.8) - left, -bottom)), rng.uniform(50, 300))
    low, high = extents(body)
    return drilled(rng, body, rng.integer(1, 3), 0.12 * float((high - low).min()))


def grooved_body(rng: Sampler) -> Manifold:
    """A smooth or straight turned body cut into thin discs by rings of grooves."""
    outline = _curve(rng) if rng.chance(0.5) else np.array([[0.8, 0.0], [0.8, 1.6]])
    height, widest = outline[-1, 1], outline[:, 0].max()
    count = rng.integer(3, 12)
    pitch = height / (count + 1)
    width, depth = rng.uniform(0.25, 0.75) * pitch, rng.uniform(0.1, 0.7) * widest
    groove = {
        "square": polygon([(0, -width), (2, -width), (2, width), (0, width)]),
        "vee": polygon(
            [(0, -0.1 * width), (depth, -width), (2, -width), (2, width), (depth, width)]
        ),
        "round": offset(rectangle(2, width, (1 + width / 2, 0)), width / 2),
    }[rng.pick(("square", "vee", "round"))].scale((1, 0.5))
    section = turned_outline(outline)
    for level in range(1, count + 1):
        cut = groove.translate((widest - depth, level * pitch))
        section = section - cut
    body = turned(section)
    if rng.chance(0.5):
        radius = rng.uniform(0.2, 0.8) * max(widest - depth, 0.15)
        body -= bore_tool(rng, radius * 0.6, height + 1).translate([0, 0, height])
    if rng.chance(0.4):
        n = rng.integer(2, 6)
        flat = block((2, 4, 9), (widest * rng.uniform(0.65, 0.95) + 1, 0, 0))
        body -= union([flat.rotate([0, 0, 360.0 * k / n]) for k in range(n)])
    return body


def helical_body(rng: Sampler) -> Manifold:
    """Coarse helices of several starts, widths and hands, one on another, with blocks between."""
    level, parts = 0.0, []
    for _ in range(rng.integer(1, 3)):
        radius, starts = rng.uniform(0.3, 0.8), rng.integer(1, 4)
        turns = rng.integer(1, 5) if starts == 1 else rng.integer(1, 2)
        length = rng.log_uniform(0.3, 1.5)
        depth = rng.uniform(0.12, 0.5) * radius
        helix = threaded_rod(radius, depth, length, turns, starts, rng.chance(0.5))
        if rng.chance(0.3):
            helix = helix.mirror([1, 0, 0])
        parts.append(helix.translate([0, 0, level]))
        level += length
        if rng.chance(0.6):
            height = rng.uniform(0.08, 0.5)
            section = outline(rng, rng.uniform(0.6, 1.5), rng.uniform(0.6, 1.5))
            shift = rng.uniform(-0.2, 0.2), rng.uniform(-0.2, 0.2)
            parts.append(prism(section.translate(shift), level - 0.01, level + height))
            level += height - 0.01
    body = union(parts)
    if rng.chance(0.5):
        depth = rng.uniform(0.3, 1.2) * level
        body -= bore_tool(rng, rng.uniform(0.06, 0.2), depth).translate([0, 0, level])
    return body
