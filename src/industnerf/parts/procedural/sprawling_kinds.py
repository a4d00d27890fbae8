"""Abstract kinds that reach far with little: lattices, arms, swept bars and tubes."""

import numpy as np
from manifold3d import CrossSection, Manifold

from industnerf.parts.procedural.draws import Draws, cosine, on_grid, sine
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


def bar_lattice(draws: Draws) -> Manifold:
    """Bars between neighbors of a bent grid, some left out, some diagonal."""
    shape = draws.pick(((2, 2, 2), (3, 2, 2), (3, 3, 1), (4, 2, 1), (2, 2, 3), (5, 2, 1)))
    nodes = np.stack(np.meshgrid(*map(np.arange, shape), indexing="ij"), axis=-1)
    nodes = nodes * [draws.uniform(0.5, 1.0), draws.uniform(0.5, 1.0), draws.uniform(0.4, 1.0)]
    nodes = nodes + draws.uniforms(-0.1, 0.1, *nodes.shape)
    radius, segments = draws.uniform(0.04, 0.11), draws.pick((4, 8, 16))
    bars = []
    for index in np.ndindex(*shape):
        steps = [tuple(row) for row in np.eye(3, dtype=int)]
        if draws.chance(0.35):
            steps.append((1, 1, 0))
        for step in steps:
            other = tuple(np.add(index, step))
            if all(o < n for o, n in zip(other, shape, strict=True)) and draws.chance(0.9):
                ends = nodes[index].tolist(), nodes[other].tolist()
                bars.append(strut(*ends, radius, segments))
    return union(bars)


def bar_walk(draws: Draws) -> Manifold:
    """A bar that turns square corners in space, with blocks or discs at some of them."""
    at, bars, sizes = np.zeros(3), [], draws.uniforms(0.08, 0.25, 2)
    last = -1
    for _ in range(draws.integer(3, 7)):
        axis = draws.pick([i for i in range(3) if i != last])
        step = np.eye(3)[axis] * draws.sign() * draws.uniform(0.4, 1.0)
        low, high = np.minimum(at, at + step), np.maximum(at, at + step)
        thick = np.full(3, sizes[0])
        thick[2] = sizes[1]
        bars.append(block((high - low + thick).tolist(), ((low + high) / 2).tolist()))
        at, last = at + step, axis
        if draws.chance(0.4):
            disc = cylinder(draws.uniform(1.0, 1.8) * sizes[0], 1.2 * sizes[1])
            bore = bore_tool(draws, 0.5 * sizes[0], 9).translate([0, 0, 0.6 * sizes[1]])
            bars.append(facing(draws.pick(SIDES), disc - bore, at.tolist()))
    return union(bars)


def swept_tube(draws: Draws) -> Manifold:
    """A bar or open tube of any section along a curve in space, with blocks at its ends."""
    count = draws.integer(3, 5)
    knots = np.c_[np.arange(count) * 0.7, draws.uniforms(-0.5, 0.5, count, 2)]
    path = on_grid(smooth_path(knots, 9))
    radius = draws.uniform(0.07, 0.22)
    outer = {
        "round": circle(radius, segments=24),
        "square": rounded_rectangle(2 * radius, 1.5 * radius, 0.3 * radius),
        "lobed": lobed(draws, radius, (3,), 0.25),
    }[draws.pick(("round", "square", "lobed"))]
    is_open = draws.chance(0.6)
    body = swept(outer - outer.scale((0.75, 0.75)) if is_open else outer, path)
    for end, before in ((path[0], path[1]), (path[-1], path[-2])):
        if draws.chance(0.4):
            outward = (end - before) / np.linalg.norm(end - before)
            size = draws.uniform(2.2, 4.0) * radius, draws.uniform(2.2, 3.0) * radius
            foot = rectangle(*size, (draws.uniform(-0.5, 0.5) * radius, 0))
            length = draws.uniform(0.5, 1.5) * radius
            body += swept(foot, np.stack([end - length * outward, end + 0.02 * outward]))
    return body


def swept_bar(draws: Draws) -> Manifold:
    """A profile with corners along a plane curve: hooks, bows and waves."""
    size = draws.uniform(0.1, 0.3), draws.uniform(0.1, 0.5)
    section = {
        "full": rounded_rectangle(*size, 0.2 * size[0]),
        "hollow": rectangle(*size) - rectangle(0.7 * size[0], 0.7 * size[1]),
        "channel": rectangle(*size) - rectangle(0.6 * size[0], size[1], (0, 0.25 * size[1])),
        "irregular": fillet(irregular_polygon(draws, 6, *size), 0.015),
    }[draws.pick(("full", "hollow", "channel", "irregular"))]
    heading = np.cumsum(np.repeat(draws.uniforms(-17, 17, draws.integer(2, 4)), 9))
    turn = np.deg2rad(heading)
    step = np.c_[cosine(turn), sine(turn), np.full(len(turn), draws.uniform(0, 0.25))]
    path = np.cumsum(np.r_[np.zeros((1, 3)), 0.12 * step], axis=0)
    return swept(section.rotate(90.0 * draws.integer(0, 3)), on_grid(path))


def armed_hub(draws: Draws) -> Manifold:
    """A bored hub with arms at uneven angles, each ending in a pad of its own."""
    height, hub = draws.uniform(0.1, 0.6), draws.uniform(0.12, 0.35)
    middle = circle(hub)
    heading = np.cumsum(draws.uniforms(45, 130, draws.integer(2, 6)))
    arms, bores = [eased_prism(middle, 0, height, 0.1 * min(hub, height), 1)], []
    for turn in heading[heading < 345].tolist():
        reach, pad = draws.uniform(0.6, 1.4), draws.uniform(0.06, 0.22)
        low, thick = draws.uniform(0, 0.4) * height, draws.uniform(0.25, 0.6) * height
        end = circle(pad, (reach, 0), 28)
        web = CrossSection.batch_hull(
            [circle(0.7 * hub, segments=28), circle(0.8 * pad, (reach, 0))]
        )
        arm = prism(web, low, low + thick) + prism(end, 0, draws.uniform(0.5, 1.3) * height)
        arms.append(arm.rotate([0, 0, turn]))
        bore = bore_tool(draws, draws.uniform(0.3, 0.6) * pad, 9).translate([reach, 0, height])
        bores.append(bore.rotate([0, 0, turn]))
    bores.append(bore_tool(draws, draws.uniform(0.3, 0.7) * hub, 9).translate([0, 0, height]))
    return union(arms) - union(bores)


def armed_core(draws: Draws) -> Manifold:
    """A block or ball with arms along the axes, of different sections and lengths."""
    size = draws.uniform(0.25, 0.6)
    core = block((size,) * 3) if draws.chance(0.5) else Manifold.sphere(0.6 * size, 32)
    parts, holes = [core], []
    for index in draws.order(6)[: draws.integer(2, 6)]:
        width, reach = draws.uniform(0.25, 0.9) * size, draws.uniform(0.4, 1.4)
        section = draws.pick(
            (circle(width / 2), rectangle(width, 0.6 * width), rounded_rectangle(width, width, 0.1))
        )
        parts.append(facing(SIDES[index], prism(section, 0, reach)))
        if draws.chance(0.4):
            foot = rounded_rectangle(draws.uniform(1.2, 2.2) * width, 1.3 * width, 0.1 * width)
            parts.append(facing(SIDES[index], prism(foot, reach - 0.08, reach)))
        if draws.chance(0.6):
            tool = bore_tool(draws, draws.uniform(0.12, 0.28) * width, draws.uniform(0.3, 2.0))
            holes.append(facing(SIDES[index], tool.translate([0, 0, reach])))
    return union(parts) - union(holes)
