"""Abstract kinds of deep pockets and thin walls: plates, trays, shells, fins, panels."""

from itertools import pairwise

import numpy as np
from manifold3d import CrossSection, Manifold

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
    offset,
    outline,
    rectangle,
    rounded_rectangle,
    scatter,
    section_union,
)
from industnerf.parts.procedural.sampler import Real, Sampler, cosine, on_grid, sine


def pocketed_plate(rng: Sampler) -> Manifold:
    """A plate with pockets of several depths and a perforated field."""
    x, y, z = rng.box("plate", "slab", "slab")
    section = outline(rng, x, y)
    body = prism(section, 0, z) - union(cut_top(rng, section, z, rng.integer(2, 9)))
    if rng.chance(0.4):
        field = hole_pattern(rng, 0.6 * x, 0.6 * y)
        body -= prism(field, rng.uniform(-0.5, 0.6) * z, 2 * z)
    return body


def pocketed_block(rng: Sampler) -> Manifold:
    """A block with deep pockets entering from several sides, some with an island."""
    size = rng.box("block", "block", "slab")
    body = (
        block(size)
        if rng.chance(0.5)
        else eased_prism(
            rounded_rectangle(size[0], size[1], 0.15 * min(size)),
            -size[2] / 2,
            size[2] / 2,
            0.05,
            1,
        )
    )
    for _ in range(rng.integer(1, 4)):
        side = rng.pick(SIDES)
        axis = "xyz".index(side[1])
        width, height = (size[i] for i in range(3) if i != axis)
        section = rounded_rectangle(
            rng.uniform(0.3, 0.85) * width,
            rng.uniform(0.3, 0.85) * height,
            rng.uniform(0, 0.3) * min(width, height),
        )
        if rng.chance(0.35):
            section = section - cutout(rng, 0.25 * min(width, height))
        if axis < 2:
            section = section.rotate(90.0) if axis == 0 else section
        at = np.zeros(3)
        at[axis] = size[axis] / 2 * (1 if side[0] == "+" else -1)
        tool = facing(side, pocket_tool(section, rng.uniform(0.3, 0.92) * size[axis]), at.tolist())
        if (body - tool).volume() > 0.15 * body.volume():
            body -= tool
    return body


def ribbed_plate(rng: Sampler) -> Manifold:
    """A plate with thin ribs at several angles, bosses between and holes."""
    x, y, z = rng.box("plate")
    section = outline(rng, x, y)
    body = prism(section, 0, z)
    height = rng.uniform(0.5, 5.0) * z
    body += ribs(rng, section, z, height, rng.integer(2, 7))
    if rng.chance(0.6):
        body += bosses(rng, section, z, rng.integer(1, 4))
    if rng.chance(0.5):
        body -= union(cut_top(rng, section, z, 3))
    return body


def fin_field(rng: Sampler) -> Manifold:
    """Thin fins of uneven height, pitch and length on a base, or slits that leave them."""
    x, y, z = rng.box("block", "slab")
    base, count = rng.uniform(0.03, 0.3) * z, rng.integer(3, 14)
    edges = np.cumsum(np.r_[0, rng.uniforms(0.4, 1.0, 2 * count)])
    edges = on_grid(edges / edges[-1] * y - y / 2)
    fins = []
    for start, end in zip(edges[::2], edges[1::2], strict=False):
        length, height = rng.uniform(0.4, 1.0) * x, rng.uniform(0.4, 1.0) * z
        at = rng.uniform(-0.5, 0.5) * (x - length)
        fins.append(prism(rectangle(length, end - start, (at, (start + end) / 2)), 0, height))
    body = prism(rounded_rectangle(x, y, 0.1 * y), 0, base) + union(fins)
    if rng.chance(0.4):
        _, high = extents(body)
        cut = rectangle(x, rng.uniform(0.1, 0.4) * y).rotate(rng.uniform(-60, 60))
        body -= prism(cut, base, 3 * high[2])
    if rng.chance(0.4):
        body ^= prism(outline(rng, x, y), -1, 9)
    return body


def fins_around(rng: Sampler) -> Manifold:
    """Thin walls standing out of a core at uneven angles, with uneven reach."""
    height, core = rng.log_uniform(0.15, 1.6), outline(rng, 0.7, 0.7)
    heading = np.cumsum(rng.uniforms(12, 60, rng.integer(4, 14)))
    walls = []
    for turn in heading[heading < 350].tolist():
        reach, thickness = rng.uniform(0.4, 1.0), rng.uniform(0.02, 0.07)
        fin = prism(rectangle(reach, thickness, (reach / 2, 0)), 0, rng.uniform(0.5, 1.0) * height)
        walls.append(fin.rotate([0, 0, turn]))
    body = prism(core, 0, rng.uniform(0.2, 1.2) * height) + union(walls)
    if rng.chance(0.5):
        body -= cylinder(rng.uniform(0.04, 0.12), 9)
    return body


def walled_tray(rng: Sampler) -> Manifold:
    """A random outline hollowed from the top, with inner walls, bosses and a rim."""
    x, y, z = rng.box("block", "slab", "slab")
    thickness = rng.uniform(0.02, 0.1) * min(x, y)
    section = outline(rng, x, y)
    inner = inset(section, thickness)
    floor = rng.uniform(0.5, 2.0) * thickness
    body = prism(section, 0, z) - prism(inner, floor, z + 1)
    if rng.chance(0.6):
        body += ribs(rng, inner, floor, rng.uniform(0.3, 1.0) * (z - floor), rng.integer(1, 4))
    if rng.chance(0.5):
        body += bosses(rng, inner, floor, rng.integer(1, 5)) ^ prism(section, 0, z)
    if rng.chance(0.4):
        rim = offset(section, rng.uniform(0.5, 2.5) * thickness) - inner
        body += prism(rim, z - thickness, z)
    if rng.chance(0.5):
        side = rng.pick(SIDES[2:])
        window = cutout(rng, rng.uniform(0.4, 0.9) * z).extrude(1.5)
        body -= facing(side, window, (0, 0, rng.uniform(0.4, 0.9) * z))
    return body


def windowed_shell(rng: Sampler) -> Manifold:
    """A hollow block of thin walls, opened by windows on several sides."""
    size = np.array(rng.box("block", "slab", "beam"))
    small = float(size.min())
    thickness = rng.uniform(0.05, 0.15) * small
    radius = rng.uniform(0, 0.3) * small
    outer = prism(rounded_rectangle(*size[:2], radius), -size[2] / 2, size[2] / 2)
    hollow = size - 2 * thickness
    inner = rounded_rectangle(*hollow[:2], max(0, radius - thickness))
    body = outer - prism(inner, -hollow[2] / 2, hollow[2] / 2)
    sides = [SIDES[i] for i in rng.order(6)[: rng.integer(1, 5)]]
    for side in sides:
        axis = "xyz".index(side[1])
        width = float(min(size[i] for i in range(3) if i != axis))
        window = cutout(rng, rng.uniform(0.4, 0.85) * width)
        body -= facing(side, prism(window, 0.5 * hollow[axis] - 0.1 * small, 3))
    return body


def perforated_panel(rng: Sampler) -> Manifold:
    """A thin panel full of equal holes, flat with a rim or bent about an axis."""
    x, y, z = rng.box("plate")
    section = outline(rng, x, y)
    field = hole_pattern(rng, x, y)
    rim = rng.uniform(0.04, 0.12) * min(x, y)
    sheet = section - (field ^ inset(section, rim))
    if rng.chance(0.5):
        body = prism(sheet, 0, z)
        return body + prism(section - inset(section, 0.7 * rim), 0, rng.uniform(1, 5) * z)
    return _bent(sheet, z, rng.uniform(0.35, 1.2))


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


def terraces(rng: Sampler) -> Manifold:
    """Columns of uneven height on a grid, some missing: stairs, towers and deep wells."""
    nx, ny = rng.integer(2, 6), rng.integer(2, 5)
    pitch, levels = 1.0 / max(nx, ny), rng.integer(2, 6)
    tall = rng.log_uniform(0.15, 1.2)
    columns = []
    for i in range(nx):
        for j in range(ny):
            height = 0.08 + tall * rng.integer(0, levels) / levels
            at = pitch * (i + 0.5), pitch * (j + 0.5)
            columns.append((height, rectangle(1.001 * pitch, 1.001 * pitch, at)))
    heights = sorted({height for height, _ in columns})
    radius = rng.uniform(0, 0.2) * pitch
    layers, below = [], -0.01
    for height in heights:
        section = section_union([square for tall, square in columns if tall >= height])
        layers.append(prism(fillet(section, radius, radius), below, height))
        below = height - 0.001
    return union(layers)


def boss_cluster(rng: Sampler) -> Manifold:
    """A base crowded with bored bosses of all sizes, on one side or both."""
    x, y, z = rng.box("plate", "slab")
    section = outline(rng, x, y)
    body = prism(section, 0, z) + bosses(rng, section, z, rng.integer(4, 12))
    if rng.chance(0.4):
        below = bosses(rng, section, 0, rng.integer(1, 5))
        body += below.mirror([0, 0, 1])
    return body


def stacked_plates(rng: Sampler) -> Manifold:
    """Thin plates one above another, held apart by posts."""
    count, gap = rng.integer(2, 6), rng.uniform(0.08, 0.4)
    thickness = rng.uniform(0.02, 0.1)
    first = outline(rng, 1.0, rng.uniform(0.6, 1.0))
    posts = scatter(rng, first, rng.integer(2, 5), 0.03, 0.12, 0.02)
    is_same = rng.chance(0.5)
    shared, plates = first, []
    for level in range(count):
        section = first if is_same or level == 0 else outline(rng, 1.0, rng.uniform(0.6, 1.0))
        shared = shared ^ section
        base = level * (gap + thickness)
        plates.append(prism(section, base, base + thickness))
    height = (count - 1) * (gap + thickness) + thickness
    columns = [cylinder(r, height, (x, y, height / 2), segments=24) for x, y, r in posts]
    body = union([*plates, *columns])
    if posts and rng.chance(0.5):
        body -= union([cylinder(0.5 * r, 9, (x, y, 0), segments=20) for x, y, r in posts])
    return body
