"""Plane outlines: what is extruded, revolved or swept, and the shapes of holes."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from jaxtyping import Bool, Float
from manifold3d import CrossSection, JoinType, OpType

from industnerf.parts.procedural.sampler import Real, Sampler, cosine, on_grid, sine

SEGMENTS = 40  # of a full circle
FILLET_SEGMENTS = 24  # of a full circle that an offset rounds corners by

Points2 = Float[np.ndarray, "n 2"]


def polygon(points: Points2 | Sequence[tuple[Real, Real]]) -> CrossSection:
    """The inside of a closed line, whichever way it runs."""
    corners = on_grid(np.asarray(points, np.float64))
    x, y = corners.T
    is_clockwise = (x * np.roll(y, -1) - y * np.roll(x, -1)).sum() < 0
    return CrossSection([corners[::-1] if is_clockwise else corners])


def rectangle(width: Real, height: Real, center: tuple[Real, Real] = (0, 0)) -> CrossSection:
    return CrossSection.square([width, height], True).translate(center)


def circle(
    radius: Real, center: tuple[Real, Real] = (0, 0), segments: int = SEGMENTS
) -> CrossSection:
    return CrossSection.circle(radius, segments).translate(center)


def offset(section: CrossSection, distance: Real, is_round: bool = True) -> CrossSection:
    """The section grown by `distance`, shrunk where it is negative; corners round or sharp."""
    join = JoinType.Round if is_round else JoinType.Miter
    return section.offset(distance, join, 4.0, FILLET_SEGMENTS)


def fillet(section: CrossSection, convex: Real, concave: Real = 0.0) -> CrossSection:
    """The section with its corners rounded by these radii.

    What is thinner than twice `convex` vanishes; gaps narrower than twice `concave` close.
    """
    if convex > 0:
        section = offset(offset(section, -convex), convex)
    if concave > 0:
        section = offset(offset(section, concave), -concave)
    return section


def rounded_rectangle(width: Real, height: Real, radius: Real) -> CrossSection:
    radius = min(radius, 0.49 * width, 0.49 * height)
    if radius <= 0:
        return rectangle(width, height)
    return offset(rectangle(width - 2 * radius, height - 2 * radius), radius)


def slot(length: Real, width: Real) -> CrossSection:
    """A rectangle with half circles at its ends, `length` over all, along x."""
    return rounded_rectangle(length, width, width / 2)


def section_union(sections: Sequence[CrossSection]) -> CrossSection:
    return CrossSection.batch_boolean(list(sections), OpType.Add)


def angles(n: int, start: Real = 0.0) -> Float[np.ndarray, "n"]:
    """`n` even angles of a full turn, radians."""
    return start + 2 * np.pi * np.arange(n) / n


def on_circle(n: int, radius: Real, start: Real = 0.0) -> list[tuple[float, float]]:
    """`n` even points of a circle."""
    turn = angles(n, start)
    points = on_grid(radius * np.stack([cosine(turn), sine(turn)], axis=1))
    return [(x, y) for x, y in points.tolist()]


def irregular_polygon(rng: Sampler, corners: int, width: Real, height: Real) -> CrossSection:
    """Corners at uneven angles and distances, within about `width` by `height`, sharp."""
    turn = angles(corners) + rng.uniforms(-0.35, 0.35, corners) * 2 * np.pi / corners
    radius = rng.uniforms(0.55, 1.0, corners)
    half = np.array([width, height]) / 2
    return polygon(half * radius[:, None] * np.stack([cosine(turn), sine(turn)], axis=1))


def lobed(rng: Sampler, radius: Real, harmonics: Sequence[int], depth: Real) -> CrossSection:
    """A smooth closed line r(a) = radius (1 + sum of waves), each of at most `depth`."""
    turn = angles(2 * SEGMENTS)
    waves = [
        rng.uniform(0.3, 1.0) * depth * cosine(k * turn + rng.uniform(0, 2 * np.pi))
        for k in harmonics
    ]
    reach = radius * (1 + np.sum(waves, axis=0))
    return polygon(reach[:, None] * np.stack([cosine(turn), sine(turn)], axis=1))


def notched_rectangle(rng: Sampler, width: Real, height: Real) -> CrossSection:
    """A rectangle with steps, slits and tabs along its sides."""
    section = rectangle(width, height)
    for _ in range(rng.integer(1, 4)):
        size = rng.uniform(0.1, 0.45) * width, rng.uniform(0.1, 0.6) * height
        at = rng.uniform(-0.5, 0.5) * width, rng.sign() * 0.5 * height
        cut = rectangle(*size, at)
        is_tab = rng.chance(0.3)
        section = section + cut if is_tab else section - cut
    return section


def outline(rng: Sampler, width: Real, height: Real) -> CrossSection:
    """A random outline of a plate or prism within about `width` by `height`, often filleted."""
    small = min(width, height)
    form = rng.pick(("irregular", "irregular", "notched", "notched", "rounded", "lobed", "hull"))
    if form == "irregular":
        section = irregular_polygon(rng, rng.integer(3, 9), width, height)
    elif form == "notched":
        section = notched_rectangle(rng, width, height)
    elif form == "rounded":
        return rounded_rectangle(width, height, rng.uniform(0.0, 0.5) * small)
    elif form == "lobed":
        section = lobed(rng, 0.5, rng.order(4)[:2], 0.25).scale([width, height])
    else:
        discs = [
            circle(r * small, (x * (width / 2 - r * small), y * (height / 2 - r * small)))
            for x, y, r in np.c_[rng.uniforms(-1, 1, 4, 2), rng.uniforms(0.05, 0.3, 4)].tolist()
        ]
        return CrossSection.batch_hull(discs)
    if rng.chance(0.6):
        rounded = fillet(section, rng.uniform(0.01, 0.1) * small, rng.uniform(0, 0.1) * small)
        section = section if rounded.is_empty() else rounded
    return section


def cutout(rng: Sampler, size: Real) -> CrossSection:
    """The outline of a hole or pocket, centered, that fits in a circle of diameter `size`."""
    form = rng.pick(("circle", "circle", "slot", "rounded", "polygon", "irregular"))
    if form == "circle":
        return circle(size / 2)
    if form == "slot":
        return slot(size, rng.uniform(0.2, 0.6) * size).rotate(15.0 * rng.integer(0, 11))
    if form == "rounded":
        long, short = 0.8 * size, rng.uniform(0.3, 0.55) * size
        section = rounded_rectangle(long, short, rng.uniform(0.1, 0.5) * short)
        return section.rotate(45.0 * rng.integer(0, 3))
    if form == "polygon":
        return CrossSection.circle(size / 2, rng.integer(3, 8))
    return fillet(irregular_polygon(rng, rng.integer(4, 7), size, size), 0.06 * size)


def wall(points: Points2, thickness: Real) -> CrossSection:
    """A strip of `thickness` along an open line, with round joints."""
    discs = [circle(thickness / 2, (x, y), 16) for x, y in on_grid(points).tolist()]
    return section_union([CrossSection.batch_hull(list(pair)) for pair in pairwise(discs)])


def contains(section: CrossSection, points: Points2) -> Bool[np.ndarray, "n"]:
    """Which points are inside, by the even-odd rule."""
    inside = np.zeros(len(points), bool)
    x, y = points[:, :1], points[:, 1:]
    for corners in section.to_polygons():
        a, b = corners, np.roll(corners, -1, axis=0)
        rise = np.where(b[:, 1] == a[:, 1], 1.0, b[:, 1] - a[:, 1])
        crossing = a[:, 0] + (y - a[:, 1]) / rise * (b[:, 0] - a[:, 0])
        spans = (a[:, 1] > y) != (b[:, 1] > y)
        inside ^= (spans & (x < crossing)).sum(axis=1) % 2 == 1
    return inside


def scatter(
    rng: Sampler, section: CrossSection, count: int, smallest: Real, largest: Real, gap: Real
) -> list[tuple[float, float, float]]:
    """Up to `count` circles (x, y, radius) inside `section`, `gap` apart and from its edge."""
    left, bottom, right, top = section.bounds()
    placed: list[tuple[float, float, float]] = []
    for radius in sorted((rng.uniform(smallest, largest) for _ in range(count)), reverse=True):
        room = offset(section, -radius - gap, is_round=False)
        candidates = np.c_[rng.uniforms(left, right, 24), rng.uniforms(bottom, top, 24)]
        free = contains(room, candidates)
        for x, y, r in placed:
            away = ((candidates - [x, y]) ** 2).sum(axis=1)
            free &= away > (radius + r + gap) ** 2
        if free.any():
            x, y = candidates[np.argmax(free)].tolist()
            placed.append((x, y, radius))
    return placed


def hole_pattern(rng: Sampler, width: Real, height: Real) -> CrossSection:
    """Equal small holes on a square, hexagonal or circular grid within `width` by `height`."""
    small = min(width, height)
    pitch = rng.uniform(0.12, 0.35) * small
    form = rng.pick(("square", "hexagonal", "circular"))
    if form == "circular":
        n = rng.integer(3, 12)
        reach = rng.uniform(0.25, 0.42) * small
        centers = np.array(on_circle(n, reach, rng.uniform(0, 3)))
        pitch = min(pitch, 2 * reach * np.pi / n)
    else:
        nx, ny = max(1, int(width / pitch)), max(1, int(height / pitch))
        i, j = np.meshgrid(np.arange(nx), np.arange(ny))
        i = i + (0.5 * (j % 2) - 0.25 if form == "hexagonal" else 0)
        centers = pitch * np.c_[i.ravel() - (nx - 1) / 2, j.ravel() - (ny - 1) / 2]
    hole = CrossSection.circle(rng.uniform(0.2, 0.4) * pitch, rng.pick((4, 6, 12, 16)))
    return CrossSection.compose([hole.translate(center) for center in on_grid(centers).tolist()])
