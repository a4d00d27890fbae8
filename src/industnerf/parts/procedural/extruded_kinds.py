"""Abstract kinds that are extruded: random outlines, one or several, along one axis or several."""

import numpy as np
from manifold3d import CrossSection, Manifold

from industnerf.parts.procedural.features import bore_tool, cut_top, drilled, extents, inset
from industnerf.parts.procedural.primitives import (
    cylinder,
    eased_prism,
    facing,
    prism,
    union,
)
from industnerf.parts.procedural.profiles import (
    circle,
    cutout,
    fillet,
    lobed,
    outline,
    rectangle,
    scatter,
    wall,
)
from industnerf.parts.procedural.sampler import Real, Sampler, cosine, sine


def bored_prism(rng: Sampler) -> Manifold:
    """A prism of a random outline with bores and pockets from the top and from the sides."""
    x, y, z = rng.box("block", "slab", "slab", "plate")
    section = outline(rng, x, y)
    body = prism(section, 0, z)
    tools = cut_top(rng, section, z, rng.integer(1, 6))
    body -= union(tools)
    if z > 0.2 and rng.chance(0.4):
        body = drilled(rng, body, rng.integer(1, 2), 0.15 * min(x, y, z))
    return body


def eased_block(rng: Sampler) -> Manifold:
    """A convex prism with chamfered or rounded edges, bored, slotted and stepped."""
    x, y, z = rng.box()
    small = min(x, y, z)
    section = outline(rng, x, y).hull()
    ease = rng.uniform(0.05, 0.3) * small
    body = eased_prism(section, 0, z, ease, rng.pick((1, 1, 5)))
    body = drilled(rng, body, rng.integer(1, 4), 0.25 * small)
    if rng.chance(0.5):
        step = prism(rectangle(2 * x, 2 * y, (rng.uniform(0.8, 1.3) * x, 0)), 0.4 * z, 2 * z)
        body -= step.rotate([0, 0, 90.0 * rng.integer(0, 3)])
    return body


def lobed_prism(rng: Sampler) -> Manifold:
    """A wavy outline of few lobes with a window or a set of holes, sometimes tapered."""
    harmonics = [rng.integer(2, 5), rng.integer(1, 3)]
    section = lobed(rng, 0.6, harmonics, rng.uniform(0.05, 0.22))
    if rng.chance(0.5):
        section = section - inset(section, rng.uniform(0.06, 0.25))
    else:
        holes = scatter(rng, section, rng.integer(1, 7), 0.04, 0.2, 0.03)
        for x, y, radius in holes:
            section = section - cutout(rng, 2 * radius).translate((x, y))
    top = (1.0, 1.0) if rng.chance(0.6) else (rng.uniform(0.4, 1.0),) * 2
    return section.extrude(rng.log_uniform(0.06, 2.0), 0, 0.0, top)


def twisted_prism(rng: Sampler) -> Manifold:
    """A random outline turned and narrowed as it rises, sometimes with a straight bore."""
    section = outline(rng, rng.uniform(0.5, 1.0), rng.uniform(0.5, 1.0))
    left, bottom, right, top = section.bounds()
    section = section.translate((-(left + right) / 2, -(bottom + top) / 2))
    height, twist = rng.log_uniform(0.4, 2.2), rng.uniform(20, 200)
    scale = rng.uniform(0.5, 1.0), rng.uniform(0.5, 1.0)
    body = section.extrude(height, 20, twist, scale)
    if rng.chance(0.5):
        radius = rng.uniform(0.03, 0.12)
        body -= bore_tool(rng, radius, rng.uniform(0.4, 1.5) * height).translate([0, 0, height])
    return body.mirror([1, 0, 0]) if rng.chance(0.5) else body


def stacked_prisms(rng: Sampler) -> Manifold:
    """Prisms of different outlines one on another, off center, bored through."""
    level, layers, count = 0.0, [], rng.integer(2, 5)
    for _ in range(count):
        height = rng.log_uniform(0.06, 0.9)
        section = outline(rng, rng.uniform(0.3, 1.2), rng.uniform(0.3, 1.2))
        shift = rng.uniform(-0.15, 0.15), rng.uniform(-0.15, 0.15)
        layers.append(prism(section.translate(shift), level - 0.01, level + height))
        level += height
    body = union(layers)
    if rng.chance(0.6):
        tool = bore_tool(rng, rng.uniform(0.04, 0.14), rng.uniform(0.3, 1.2) * level)
        body -= tool.translate([rng.uniform(-0.1, 0.1), rng.uniform(-0.1, 0.1), level])
    return body


def crossed_prisms(rng: Sampler) -> Manifold:
    """Two or three prisms along different axes, joined; one may be cut out instead."""
    parts = []
    for side in ("+z", "+x", "+y")[: rng.integer(2, 3)]:
        section = outline(rng, rng.uniform(0.25, 0.9), rng.uniform(0.25, 0.9))
        half = rng.uniform(0.25, 0.9)
        at = rng.uniforms(-0.2, 0.2, 3).tolist()
        parts.append(facing(side, prism(section, -half, half), at))
    body = union(parts)
    side, hole = rng.pick(("+z", "+x", "+y")), cutout(rng, rng.uniform(0.12, 0.4))
    return body - facing(side, prism(hole, -3, 3), rng.uniforms(-0.1, 0.1, 3).tolist())


def intersected_prisms(rng: Sampler) -> Manifold:
    """What two or three prisms along different axes have in common."""
    x, y, z = rng.box("block", "slab", "beam")
    body = prism(outline(rng, x, y), -z, z)
    other = facing("+y", prism(outline(rng, x, z), -2, 2))
    body ^= other
    if rng.chance(0.4):
        body ^= facing("+x", prism(outline(rng, z, y), -2, 2))
    if rng.chance(0.7):
        low, high = extents(body)
        body = drilled(rng, body, rng.integer(1, 3), 0.15 * float((high - low).min()))
    return body


def folded_sheet(rng: Sampler) -> Manifold:
    """A thin wall along a random line, extruded, with cutouts and holes."""
    count = rng.integer(3, 8)
    heading = np.cumsum(np.r_[0, rng.uniforms(-100, 100, count - 1)])
    step = rng.uniforms(0.25, 0.8, count)[:, None]
    turn = np.deg2rad(heading)
    path = np.cumsum(np.r_[np.zeros((1, 2)), step * np.c_[cosine(turn), sine(turn)]], axis=0)
    section = wall(path, rng.uniform(0.03, 0.12))
    section = fillet(section, 0, rng.uniform(0.01, 0.1))
    return _windowed(rng, section, rng.log_uniform(0.15, 2.0))


def corrugated_sheet(rng: Sampler) -> Manifold:
    """A thin wall along a wave of any shape, extruded, with cutouts."""
    waves, amplitude = rng.integer(2, 6), rng.uniform(0.08, 0.4)
    along = np.linspace(0, waves, 4 * waves + 1 if rng.chance(0.5) else 12 * waves + 1)
    form = rng.pick(("sine", "vee", "square"))
    if form == "sine":
        across = sine(2 * np.pi * along)
    elif form == "vee":
        across = 1 - 4 * np.abs(along % 1 - 0.5)
    else:
        along = np.repeat(np.arange(2 * waves + 1) / 2, 2)
        across = np.tile([1, -1, -1, 1], waves + 1)[: len(along)]
    bow = rng.uniform(-0.3, 0.3) * ((along / waves) * 2 - 1) ** 2
    path = np.c_[1.6 * along / waves, amplitude * across + bow]
    return _windowed(rng, wall(path, rng.uniform(0.03, 0.09)), rng.log_uniform(0.15, 1.6))


def _windowed(rng: Sampler, section: CrossSection, height: Real) -> Manifold:
    body = prism(section, 0, height)
    left, bottom, right, top = section.bounds()
    for _ in range(rng.integer(0, 3)):
        size = rng.uniform(0.2, 0.7) * min(height, 0.6)
        at = rng.uniform(left, right), rng.uniform(bottom, top)
        tool = facing(rng.pick(("+x", "+y")), prism(cutout(rng, size), -0.5, 0.5))
        body -= tool.translate([*at, rng.uniform(0.2, 0.8) * height])
    if rng.chance(0.3):
        slant = prism(rectangle(9, 9), height, height + 9)
        body -= slant.rotate([rng.uniform(-15, 15), rng.uniform(-15, 15), 0])
    return body


def open_frame(rng: Sampler) -> Manifold:
    """An outline left as a rim, with thin spokes across and bored pads inside."""
    x, y, z = rng.box("slab", "plate")
    section, small = outline(rng, x, y), min(x, y)
    inner = inset(section, rng.uniform(0.05, 0.15) * small)
    parts = [prism(section - inner, 0, z)]
    pads = scatter(rng, inner, rng.integer(0, 3), 0.07 * small, 0.14 * small, -0.1 * small)
    for px, py, radius in pads:
        parts.append(prism(circle(radius, (px, py), 28), 0, rng.uniform(0.5, 1.4) * z))
    for _ in range(rng.integer(0, 4)):
        strip = rectangle(3, rng.uniform(0.03, 0.1) * small, (0, rng.uniform(-0.3, 0.3) * y))
        strip = strip.rotate(30.0 * rng.integer(0, 5)) ^ section
        parts.append(prism(strip, 0, rng.uniform(0.3, 1.0) * z))
    bores = [cylinder(0.5 * r, 9, (px, py, 0), segments=20) for px, py, r in pads]
    return union(parts) - union(bores)
