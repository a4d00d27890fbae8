"""Abstract kinds that reach far with little: lattices, arms, swept bars and tubes."""

import numpy as np
from manifold3d import CrossSection, Manifold

from industnerf.parts.procedural.features import bore_tool
from industnerf.parts.procedural.primitives import (
    SIDES,
    block,
    cylinder,
    eased_prism,
    facing,
    prism,
    smooth_path,
    strut,
    swept,
    union,
)
from industnerf.parts.procedural.profiles import (
    circle,
    fillet,
    irregular_polygon,
    lobed,
    rectangle,
    rounded_rectangle,
)
from industnerf.parts.procedural.sampler import Sampler, cosine, on_grid, sine


def bar_lattice(rng: Sampler) -> Manifold:
    """Bars between neighbors of a bent grid, some left out, some diagonal."""
    shape = rng.pick(((2, 2, 2), (3, 2, 2), (3, 3, 1), (4, 2, 1), (2, 2, 3), (5, 2, 1)))
    nodes = np.stack(np.meshgrid(*map(np.arange, shape), indexing="ij"), axis=-1)
    nodes = nodes * [rng.uniform(0.5, 1.0), rng.uniform(0.5, 1.0), rng.uniform(0.4, 1.0)]
    nodes = nodes + rng.uniforms(-0.1, 0.1, *nodes.shape)
    radius, segments = rng.uniform(0.04, 0.11), rng.pick((4, 8, 16))
    bars = []
    for index in np.ndindex(*shape):
        steps = [tuple(row) for row in np.eye(3, dtype=int)]
        if rng.chance(0.35):
            steps.append((1, 1, 0))
        for step in steps:
            other = tuple(np.add(index, step))
            if all(o < n for o, n in zip(other, shape, strict=True)) and rng.chance(0.9):
                ends = nodes[index].tolist(), nodes[other].tolist()
                bars.append(strut(*ends, radius, segments))
    return union(bars)


def bar_walk(rng: Sampler) -> Manifold:
    """A bar that turns square corners in space, with blocks or discs at some of them."""
    at, bars, sizes = np.zeros(3), [], rng.uniforms(0.08, 0.25, 2)
    last = -1
    for _ in range(rng.integer(3, 7)):
        axis = rng.pick([i for i in range(3) if i != last])
        step = np.eye(3)[axis] * rng.sign() * rng.uniform(0.4, 1.0)
        low, high = np.minimum(at, at + step), np.maximum(at, at + step)
        thick = np.full(3, sizes[0])
        thick[2] = sizes[1]
        bars.append(block((high - low + thick).tolist(), ((low + high) / 2).tolist()))
        at, last = at + step, axis
        if rng.chance(0.4):
            disc = cylinder(rng.uniform(1.0, 1.8) * sizes[0], 1.2 * sizes[1])
            bore = bore_tool(rng, 0.5 * sizes[0], 9).translate([0, 0, 0.6 * sizes[1]])
            bars.append(facing(rng.pick(SIDES), disc - bore, at.tolist()))
    return union(bars)


def swept_tube(rng: Sampler) -> Manifold:
    """A bar or open tube of any section along a curve in space, with blocks at its ends."""
    count = rng.integer(3, 5)
    knots = np.c_[np.arange(count) * 0.7, rng.uniforms(-0.5, 0.5, count, 2)]
    path = on_grid(smooth_path(knots, 9))
    radius = rng.uniform(0.07, 0.22)
    outer = {
        "round": circle(radius, segments=24),
        "square": rounded_rectangle(2 * radius, 1.5 * radius, 0.3 * radius),
        "lobed": lobed(rng, radius, (3,), 0.25),
    }[rng.pick(("round", "square", "lobed"))]
    is_open = rng.chance(0.6)
    body = swept(outer - outer.scale((0.75, 0.75)) if is_open else outer, path)
    for end, before in ((path[0], path[1]), (path[-1], path[-2])):
        if rng.chance(0.4):
            outward = (end - before) / np.linalg.norm(end - before)
            size = rng.uniform(2.2, 4.0) * radius, rng.uniform(2.2, 3.0) * radius
            foot = rectangle(*size, (rng.uniform(-0.5, 0.5) * radius, 0))
            length = rng.uniform(0.5, 1.5) * radius
            body += swept(foot, np.stack([end - length * outward, end + 0.02 * outward]))
    return body


def swept_bar(rng: Sampler) -> Manifold:
    """A profile with corners along a plane curve: hooks, bows and waves."""
    size = rng.uniform(0.1, 0.3), rng.uniform(0.1, 0.5)
    section = {
        "full": rounded_rectangle(*size, 0.2 * size[0]),
        "hollow": rectangle(*size) - rectangle(0.7 * size[0], 0.7 * size[1]),
        "channel": rectangle(*size) - rectangle(0.6 * size[0], size[1], (0, 0.25 * size[1])),
        "irregular": fillet(irregular_polygon(rng, 6, *size), 0.015),
    }[rng.pick(("full", "hollow", "channel", "irregular"))]
    heading = np.cumsum(np.repeat(rng.uniforms(-17, 17, rng.integer(2, 4)), 9))
    turn = np.deg2rad(heading)
    step = np.c_[cosine(turn), sine(turn), np.full(len(turn), rng.uniform(0, 0.25))]
    path = np.cumsum(np.r_[np.zeros((1, 3)), 0.12 * step], axis=0)
    return swept(section.rotate(90.0 * rng.integer(0, 3)), on_grid(path))


def armed_hub(rng: Sampler) -> Manifold:
    """A bored hub with arms at uneven angles, each ending in a pad of its own."""
    height, hub = rng.uniform(0.1, 0.6), rng.uniform(0.12, 0.35)
    middle = circle(hub)
    heading = np.cumsum(rng.uniforms(45, 130, rng.integer(2, 6)))
    arms, bores = [eased_prism(middle, 0, height, 0.1 * min(hub, height), 1)], []
    for turn in heading[heading < 345].tolist():
        reach, pad = rng.uniform(0.6, 1.4), rng.uniform(0.06, 0.22)
        low, thick = rng.uniform(0, 0.4) * height, rng.uniform(0.25, 0.6) * height
        end = circle(pad, (reach, 0), 28)
        web = CrossSection.batch_hull(
            [circle(0.7 * hub, segments=28), circle(0.8 * pad, (reach, 0))]
        )
        arm = prism(web, low, low + thick) + prism(end, 0, rng.uniform(0.5, 1.3) * height)
        arms.append(arm.rotate([0, 0, turn]))
        bore = bore_tool(rng, rng.uniform(0.3, 0.6) * pad, 9).translate([reach, 0, height])
        bores.append(bore.rotate([0, 0, turn]))
    bores.append(bore_tool(rng, rng.uniform(0.3, 0.7) * hub, 9).translate([0, 0, height]))
    return union(arms) - union(bores)


def armed_core(rng: Sampler) -> Manifold:
    """A block or ball with arms along the axes, of different sections and lengths."""
    size = rng.uniform(0.25, 0.6)
    core = block((size,) * 3) if rng.chance(0.5) else Manifold.sphere(0.6 * size, 32)
    parts, holes = [core], []
    for index in rng.order(6)[: rng.integer(2, 6)]:
        width, reach = rng.uniform(0.25, 0.9) * size, rng.uniform(0.4, 1.4)
        section = rng.pick(
            (circle(width / 2), rectangle(width, 0.6 * width), rounded_rectangle(width, width, 0.1))
        )
        parts.append(facing(SIDES[index], prism(section, 0, reach)))
        if rng.chance(0.4):
            foot = rounded_rectangle(rng.uniform(1.2, 2.2) * width, 1.3 * width, 0.1 * width)
            parts.append(facing(SIDES[index], prism(foot, reach - 0.08, reach)))
        if rng.chance(0.6):
            tool = bore_tool(rng, rng.uniform(0.12, 0.28) * width, rng.uniform(0.3, 2.0))
            holes.append(facing(SIDES[index], tool.translate([0, 0, reach])))
    return union(parts) - union(holes)
