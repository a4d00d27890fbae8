"""Abstract kinds of deep pockets and thin walls: plates, trays, shells, fins, panels."""

from itertools import pairwise

import numpy as np
from manifold3d import CrossSection, Manifold

from industnerf.parts.procedural.draws import Draws, Real, cosine, on_grid, sine
from industnerf.parts.procedural.features import (
    bosses,
    cut_top,
    extents,
    inset,
    pocket_tool,
    ribs,
)
from industnerf.parts.procedural.primitives import (
    SIDES,
    block,
    cylinder,
    eased_prism,
    facing,
    prism,
    union,
)
from industnerf.parts.procedural.profiles import (
    cutout,
    fillet,
    hole_pattern,
    joined,
    offset,
    outline,
    rectangle,
    rounded_rectangle,
    scatter,
)


def pocketed_plate(draws: Draws) -> Manifold:
    """A plate with pockets of several depths and a perforated field."""
    x, y, z = draws.box("plate", "slab", "slab")
    section = outline(draws, x, y)
    body = prism(section, 0, z) - union(cut_top(draws, section, z, draws.integer(2, 9)))
    if draws.chance(0.4):
        field = hole_pattern(draws, 0.6 * x, 0.6 * y)
        body -= prism(field, draws.uniform(-0.5, 0.6) * z, 2 * z)
    return body


def pocketed_block(draws: Draws) -> Manifold:
    """A block with deep pockets entering from several sides, some with an island."""
    size = draws.box("block", "block", "slab")
    body = (
        block(size)
        if draws.chance(0.5)
        else eased_prism(
            rounded_rectangle(size[0], size[1], 0.15 * min(size)),
            -size[2] / 2,
            size[2] / 2,
            0.05,
            1,
        )
    )
    for _ in range(draws.integer(1, 4)):
        side = draws.pick(SIDES)
        axis = "xyz".index(side[1])
        width, height = (size[i] for i in range(3) if i != axis)
        section = rounded_rectangle(
            draws.uniform(0.3, 0.85) * width,
            draws.uniform(0.3, 0.85) * height,
            draws.uniform(0, 0.3) * min(width, height),
        )
        if draws.chance(0.35):
            section = section - cutout(draws, 0.25 * min(width, height))
        if axis < 2:
            section = section.rotate(90.0) if axis == 0 else section
        at = np.zeros(3)
        at[axis] = size[axis] / 2 * (1 if side[0] == "+" else -1)
        tool = facing(
            side, pocket_tool(section, draws.uniform(0.3, 0.92) * size[axis]), at.tolist()
        )
        if (body - tool).volume() > 0.15 * body.volume():
            body -= tool
    return body


def ribbed_plate(draws: Draws) -> Manifold:
    """A plate with thin ribs at several angles, bosses between and holes."""
    x, y, z = draws.box("plate")
    section = outline(draws, x, y)
    body = prism(section, 0, z)
    height = draws.uniform(0.5, 5.0) * z
    body += ribs(draws, section, z, height, draws.integer(2, 7))
    if draws.chance(0.6):
        body += bosses(draws, section, z, draws.integer(1, 4))
    if draws.chance(0.5):
        body -= union(cut_top(draws, section, z, 3))
    return body


def fin_field(draws: Draws) -> Manifold:
    """Thin fins of uneven height, pitch and length on a base, or slits that leave them."""
    x, y, z = draws.box("block", "slab")
    base, count = draws.uniform(0.03, 0.3) * z, draws.integer(3, 14)
    edges = np.cumsum(np.r_[0, draws.uniforms(0.4, 1.0, 2 * count)])
    edges = on_grid(edges / edges[-1] * y - y / 2)
    fins = []
    for start, end in zip(edges[::2], edges[1::2], strict=False):
        length, height = draws.uniform(0.4, 1.0) * x, draws.uniform(0.4, 1.0) * z
        at = draws.uniform(-0.5, 0.5) * (x - length)
        fins.append(prism(rectangle(length, end - start, (at, (start + end) / 2)), 0, height))
    body = prism(rounded_rectangle(x, y, 0.1 * y), 0, base) + union(fins)
    if draws.chance(0.4):
        _, high = extents(body)
        cut = rectangle(x, draws.uniform(0.1, 0.4) * y).rotate(draws.uniform(-60, 60))
        body -= prism(cut, base, 3 * high[2])
    if draws.chance(0.4):
        body ^= prism(outline(draws, x, y), -1, 9)
    return body


def fins_around(draws: Draws) -> Manifold:
    """Thin walls standing out of a core at uneven angles, with uneven reach."""
    height, core = draws.log_uniform(0.15, 1.6), outline(draws, 0.7, 0.7)
    heading = np.cumsum(draws.uniforms(12, 60, draws.integer(4, 14)))
    walls = []
    for turn in heading[heading < 350].tolist():
        reach, thickness = draws.uniform(0.4, 1.0), draws.uniform(0.02, 0.07)
        fin = prism(
            rectangle(reach, thickness, (reach / 2, 0)), 0, draws.uniform(0.5, 1.0) * height
        )
        walls.append(fin.rotate([0, 0, turn]))
    body = prism(core, 0, draws.uniform(0.2, 1.2) * height) + union(walls)
    if draws.chance(0.5):
        body -= cylinder(draws.uniform(0.04, 0.12), 9)
    return body


def walled_tray(draws: Draws) -> Manifold:
    """A random outline hollowed from the top, with inner walls, bosses and a rim."""
    x, y, z = draws.box("block", "slab", "slab")
    thickness = draws.uniform(0.02, 0.1) * min(x, y)
    section = outline(draws, x, y)
    inner = inset(section, thickness)
    floor = draws.uniform(0.5, 2.0) * thickness
    body = prism(section, 0, z) - prism(inner, floor, z + 1)
    if draws.chance(0.6):
        body += ribs(
            draws, inner, floor, draws.uniform(0.3, 1.0) * (z - floor), draws.integer(1, 4)
        )
    if draws.chance(0.5):
        body += bosses(draws, inner, floor, draws.integer(1, 5)) ^ prism(section, 0, z)
    if draws.chance(0.4):
        rim = offset(section, draws.uniform(0.5, 2.5) * thickness) - inner
        body += prism(rim, z - thickness, z)
    if draws.chance(0.5):
        side = draws.pick(SIDES[2:])
        window = cutout(draws, draws.uniform(0.4, 0.9) * z).extrude(1.5)
        body -= facing(side, window, (0, 0, draws.uniform(0.4, 0.9) * z))
    return body


def windowed_shell(draws: Draws) -> Manifold:
    """A hollow block of thin walls, opened by windows on several sides."""
    size = np.array(draws.box("block", "slab", "beam"))
    small = float(size.min())
    thickness = draws.uniform(0.05, 0.15) * small
    radius = draws.uniform(0, 0.3) * small
    outer = prism(rounded_rectangle(*size[:2], radius), -size[2] / 2, size[2] / 2)
    hollow = size - 2 * thickness
    inner = rounded_rectangle(*hollow[:2], max(0, radius - thickness))
    body = outer - prism(inner, -hollow[2] / 2, hollow[2] / 2)
    sides = [SIDES[i] for i in draws.order(6)[: draws.integer(1, 5)]]
    for side in sides:
        axis = "xyz".index(side[1])
        width = float(min(size[i] for i in range(3) if i != axis))
        window = cutout(draws, draws.uniform(0.4, 0.85) * width)
        body -= facing(side, prism(window, 0.5 * hollow[axis] - 0.1 * small, 3))
    return body


def perforated_panel(draws: Draws) -> Manifold:
    """A thin panel full of equal holes, flat with a rim or bent about an axis."""
    x, y, z = draws.box("plate")
    section = outline(draws, x, y)
    field = hole_pattern(draws, x, y)
    rim = draws.uniform(0.04, 0.12) * min(x, y)
    sheet = section - (field ^ inset(section, rim))
    if draws.chance(0.5):
        body = prism(sheet, 0, z)
        return body + prism(section - inset(section, 0.7 * rim), 0, draws.uniform(1, 5) * z)
    return _bent(sheet, z, draws.uniform(0.35, 1.2))


def _bent(section: CrossSection, thickness: Real, radius: Real) -> Manifold:
    """A sheet rolled about the y axis, in strips so that its flats follow the bend."""
    left, _, right, _ = section.bounds()
    bars = np.linspace(left, right, 25)
    strips = [
        prism(section ^ rectangle(b - a, 9, ((a + b) / 2, 0)), 0, thickness)
        for a, b in pairwise(bars)
    ]

    def bend(points: np.ndarray) -> np.ndarray:
        turn, reach = points[:, 0] / radius, radius + points[:, 2]
        return on_grid(np.c_[reach * sine(turn), points[:, 1], reach * cosine(turn)])

    return union(strips).warp_batch(bend)


def terraces(draws: Draws) -> Manifold:
    """Columns of uneven height on a grid, some missing: stairs, towers and deep wells."""
    nx, ny = draws.integer(2, 6), draws.integer(2, 5)
    pitch, levels = 1.0 / max(nx, ny), draws.integer(2, 6)
    tall = draws.log_uniform(0.15, 1.2)
    columns = []
    for i in range(nx):
        for j in range(ny):
            height = 0.08 + tall * draws.integer(0, levels) / levels
            at = pitch * (i + 0.5), pitch * (j + 0.5)
            columns.append((height, rectangle(1.001 * pitch, 1.001 * pitch, at)))
    heights = sorted({height for height, _ in columns})
    radius = draws.uniform(0, 0.2) * pitch
    layers, below = [], -0.01
    for height in heights:
        section = joined([square for tall, square in columns if tall >= height])
        layers.append(prism(fillet(section, radius, radius), below, height))
        below = height - 0.001
    return union(layers)


def boss_cluster(draws: Draws) -> Manifold:
    """A base crowded with bored bosses of all sizes, on one side or both."""
    x, y, z = draws.box("plate", "slab")
    section = outline(draws, x, y)
    body = prism(section, 0, z) + bosses(draws, section, z, draws.integer(4, 12))
    if draws.chance(0.4):
        below = bosses(draws, section, 0, draws.integer(1, 5))
        body += below.mirror([0, 0, 1])
    return body


def stacked_plates(draws: Draws) -> Manifold:
    """Thin plates one above another, held apart by posts."""
    count, gap = draws.integer(2, 6), draws.uniform(0.08, 0.4)
    thickness = draws.uniform(0.02, 0.1)
    first = outline(draws, 1.0, draws.uniform(0.6, 1.0))
    posts = scatter(draws, first, draws.integer(2, 5), 0.03, 0.12, 0.02)
    is_same = draws.chance(0.5)
    shared, plates = first, []
    for level in range(count):
        section = first if is_same or level == 0 else outline(draws, 1.0, draws.uniform(0.6, 1.0))
        shared = shared ^ section
        base = level * (gap + thickness)
        plates.append(prism(section, base, base + thickness))
    height = (count - 1) * (gap + thickness) + thickness
    columns = [cylinder(r, height, (x, y, height / 2), segments=24) for x, y, r in posts]
    body = union([*plates, *columns])
    if posts and draws.chance(0.5):
        body -= union([cylinder(0.5 * r, 9, (x, y, 0), segments=20) for x, y, r in posts])
    return body
