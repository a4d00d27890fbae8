"""Kinds that imitate a family of the study, with which they are held out."""

import numpy as np
from manifold3d import CrossSection, Manifold

from industnerf.parts.procedural.features import bore_tool, ring, threaded_rod
from industnerf.parts.procedural.primitives import (
    block,
    cylinder,
    eased_prism,
    facing,
    prism,
    swept,
    turned,
    turned_outline,
    union,
)
from industnerf.parts.procedural.profiles import (
    angles,
    circle,
    fillet,
    on_circle,
    polygon,
    rectangle,
    rounded_rectangle,
    section_union,
    slot,
)
from industnerf.parts.procedural.sampler import Real, Sampler, cosine, on_grid, sine

TALL = 9.0  # higher than any of these


def gear(rng: Sampler) -> Manifold:
    """A spur or helical gear with a web, windows and a bored hub."""
    teeth, height = rng.integer(10, 40), rng.uniform(0.1, 0.8)
    root = 1 - rng.uniform(3.6, 4.8) / teeth
    blank = _toothed(teeth, 1.0, root)
    body = blank.extrude(height, 5, rng.uniform(0, 25) if rng.chance(0.4) else 0.0)
    hub = rng.uniform(0.2, 0.35) * root
    if rng.chance(0.5):
        groove = prism(ring(0.85 * root, 1.3 * hub), 0, rng.uniform(0.2, 0.4) * height)
        body -= groove + groove.mirror([0, 0, 1]).translate([0, 0, height])
    if rng.chance(0.4):
        n, reach = rng.integer(3, 7), (hub + root) / 2
        hole = min(0.35 * (root - hub), 0.7 * reach * np.pi / n)
        body -= _holes(n, reach, hole)
    if rng.chance(0.5):
        body += prism(circle(hub), 0, height + rng.uniform(0.1, 0.6))
    return body - _holes(1, 0, rng.uniform(0.4, 0.7) * hub)


def _toothed(teeth: int, tip: Real, root: Real) -> CrossSection:
    turn = angles(teeth)[:, None] + np.array([-0.3, -0.13, 0.13, 0.3]) * 2 * np.pi / teeth
    reach = np.broadcast_to([root, tip, tip, root], turn.shape)
    return polygon((reach[..., None] * np.stack([cosine(turn), sine(turn)], -1)).reshape(-1, 2))


def _holes(n: int, reach: Real, radius: Real) -> Manifold:
    tools = [cylinder(radius, 2 * TALL, (x, y, 0), segments=24) for x, y in on_circle(n, reach)]
    return union(tools)


def bolt(rng: Sampler) -> Manifold:
    """A head with or without a socket, a shank and a thread."""
    radius, length = rng.uniform(0.15, 0.3), rng.uniform(0.5, 3.0)
    head, height = rng.uniform(1.5, 2.0) * radius, rng.uniform(0.5, 1.5) * radius
    segments, pitch = rng.pick((4, 6, 6, 40)), rng.uniform(0.25, 0.4) * radius
    body = eased_prism(circle(head, segments=segments), 0, height, 0.1 * height, 1)
    if segments == 40:
        body -= prism(circle(0.6 * head, segments=6), -1, rng.uniform(0.3, 0.7) * height)
    shank = rng.uniform(0.0, 0.6) * length
    turns = min(24, max(1, int((length - shank) / pitch)))
    thread = threaded_rod(radius, 0.15 * radius, length - shank, turns, 1, False)
    return (
        body
        + cylinder(radius, shank + 0.1, (0, 0, height + shank / 2 - 0.05))
        + thread.translate([0, 0, height + shank - 0.01])
    )


def nut(rng: Sampler) -> Manifold:
    """A nut, washer or bush: a polygon or disc with eased edges, a hole and a collar."""
    height, bore = rng.log_uniform(0.08, 1.2), rng.uniform(0.4, 0.65)
    segments = rng.pick((4, 6, 6, 40))
    body = eased_prism(circle(1.0, segments=segments), 0, height, 0.1 * min(1.0, height), 1)
    if rng.chance(0.4):
        body += prism(circle(rng.uniform(1.0, 1.3)), 0, 0.2 * height)
    if rng.chance(0.3):
        n = rng.integer(4, 8)
        notch = block((3, 0.3, 0.5 * height), (1.5, 0, height))
        body -= union([notch.rotate([0, 0, 360.0 * (k + 0.5) / n]) for k in range(n)])
    return body - _holes(1, 0, bore)


def elbow(rng: Sampler) -> Manifold:
    """A bent pipe with straight ends and collars."""
    radius, bend = rng.uniform(0.15, 0.35), rng.uniform(0.5, 1.1)
    arc, end = np.deg2rad(rng.uniform(40, 180)), rng.uniform(0.1, 0.8)
    turn = np.linspace(0, arc, 20)
    path = np.stack([bend * cosine(turn), bend * sine(turn), 0 * turn], axis=1)
    leave = np.array([-sine(arc), cosine(arc), 0.0])
    starts = path[0] - np.linspace(end, 0.05, 3)[:, None] * [0.0, 1.0, 0.0]
    path = np.concatenate([starts, path, path[-1] + np.linspace(0.05, end, 3)[:, None] * leave])
    bore = rng.uniform(0.6, 0.9) * radius
    parts = [swept(ring(radius, bore), on_grid(path))]
    if rng.chance(0.7):
        # longer than the pipe and wider inside: no two surfaces coincide
        collar = ring(rng.uniform(1.2, 1.9) * radius, (radius + bore) / 2)
        along = np.array([[-rng.uniform(0.2, 0.8) * radius], [0.02]])
        for end, outward in ((path[0], np.array([0.0, -1.0, 0.0])), (path[-1], leave)):
            parts.append(swept(collar, on_grid(end + along * outward)))
    return union(parts)


def flange(rng: Sampler) -> Manifold:
    """A disc with a bolt circle, a bored neck and a raised face."""
    height, neck = rng.uniform(0.08, 0.35), rng.uniform(0.3, 0.6)
    length = rng.uniform(0.1, 1.2)
    outline = [
        (1.0, 0.0),
        (1.0, height),
        (neck, height),
        (rng.uniform(0.7, 1) * neck, height + length),
    ]
    body = turned(fillet(turned_outline(np.array(outline)), 0.02, 0.06))
    n, reach = rng.pick((3, 4, 6, 8, 12)), (1 + neck) / 2
    hole = min(0.28 * (1 - neck), 0.6 * reach * np.pi / n)
    body -= _holes(n, reach, hole)
    if rng.chance(0.5):
        body += prism(circle(reach - 1.2 * hole), -0.15 * height, 0.01)
    return body - _holes(1, 0, rng.uniform(0.6, 0.85) * 0.7 * neck)


def spring(rng: Sampler) -> Manifold:
    """A coil of round or square wire, straight or conical."""
    turns, wire = rng.uniform(2, 8), rng.uniform(0.06, 0.2)
    length = max(rng.uniform(0.5, 3.5), 2.4 * wire * turns)
    turn = np.linspace(0, 2 * np.pi * turns, int(turns * 24))
    share = turn / turn[-1]
    reach = 1 - (rng.uniform(0, 0.5) if rng.chance(0.3) else 0.0) * share
    path = np.stack([reach * cosine(turn), reach * sine(turn), length * share], axis=1)
    section = circle(wire, segments=12) if rng.chance(0.8) else rectangle(2 * wire, 2 * wire)
    return swept(section, on_grid(path))


def heat_sink(rng: Sampler) -> Manifold:
    """Even fins or pins on a base, or round a core."""
    x, y = rng.uniform(0.7, 1.5), rng.uniform(0.7, 1.3)
    base, height = rng.uniform(0.06, 0.25), rng.uniform(0.3, 1.0)
    form = rng.pick(("fins", "pins", "round"))
    if form == "round":
        n, core = rng.integer(10, 28), rng.uniform(0.25, 0.5)
        fins = [rectangle(1, 0.06, (0.5, 0)).rotate(360.0 * k / n) for k in range(n)]
        return prism(section_union([circle(core), *fins]) - circle(0.6 * core), 0, height)
    ny = rng.integer(5, 14)
    pitch, nx = y / ny, 1 if form == "fins" else max(2, round(x * ny / y))
    fin = rectangle(x, 0.4 * pitch) if nx == 1 else circle(0.28 * pitch, segments=16)
    centers = [
        ((i + 0.5) * x / nx - x / 2, (j + 0.5) * pitch - y / 2)
        for i in range(nx)
        for j in range(ny)
    ]
    fins = CrossSection.compose([fin.translate(center) for center in centers])
    return prism(rectangle(x, y), 0, base) + prism(fins, base - 0.01, base + height)


def fan(rng: Sampler) -> Manifold:
    """Blades round a hub, twisted or slanted, some with a ring or a back plate."""
    n, height = rng.integer(3, 12), rng.uniform(0.15, 0.6)
    hub, thickness = rng.uniform(0.2, 0.4), rng.uniform(0.03, 0.08)
    blade = rectangle(1.05 - 0.8 * hub, thickness, (0.5 + 0.4 * hub, 0))
    if rng.chance(0.5):
        one = blade.extrude(height, 8, rng.uniform(10, 60))
    else:
        one = prism(blade.rotate(rng.uniform(10, 40)), 0, height)
    parts = [one.rotate([0, 0, 360.0 * k / n]) for k in range(n)] + [prism(circle(hub), 0, height)]
    if rng.chance(0.3):
        parts.append(prism(circle(1.0), 0, 0.12 * height))
    if rng.chance(0.3):
        parts.append(prism(ring(1.1, 0.98), 0, height))
    return union(parts) - _holes(1, 0, rng.uniform(0.3, 0.6) * hub)


def angle_bracket(rng: Sampler) -> Manifold:
    """Two legs at a right angle with gussets and screw holes, or a channel of three."""
    x, z, width = rng.uniform(0.5, 1.4), rng.uniform(0.5, 1.4), rng.uniform(0.3, 1.2)
    t = rng.uniform(0.05, 0.2)
    section = rectangle(x, t, (x / 2, t / 2)) + rectangle(t, z, (t / 2, z / 2))
    if rng.chance(0.3):
        section = section + rectangle(t, z, (x - t / 2, z / 2))
    body = prism(fillet(section, 0, rng.uniform(0, 0.1)), 0, width)
    if rng.chance(0.5):
        reach = rng.uniform(0.4, 0.9) * min(x, z)
        gusset = polygon([(0.5 * t, 0.5 * t), (reach, 0.5 * t), (0.5 * t, reach)])
        body += prism(gusset, 0.4 * width, 0.4 * width + t)
    hole = circle(0.12 * min(width, x, z), segments=24)
    levels = (0.25, 0.75) if rng.chance(0.6) else (0.5,)
    tools = [
        facing(side, prism(hole, -0.5 * t, 1.5 * t), at)
        for level in levels
        for side, at in (("-y", (0.7 * x, t, level * width)), ("+x", (0, 0.7 * z, level * width)))
    ]
    return body - union(tools)


def spoked_wheel(rng: Sampler) -> Manifold:
    """A rim, grooved or plain, with spokes or a disc and a bored hub."""
    height, rim = rng.uniform(0.15, 0.6), rng.uniform(0.08, 0.25)
    hub, n = rng.uniform(0.15, 0.32), rng.integer(3, 8)
    parts = [
        prism(ring(1.0, 1 - rim), 0, height),
        prism(circle(hub), 0, rng.uniform(0.8, 1.5) * height),
    ]
    if rng.chance(0.7):
        width, depth = rng.uniform(0.08, 0.2), rng.uniform(0.3, 0.7) * height
        spoke = block((1 - rim / 2, width, depth), ((1 - rim / 2) / 2, 0, height / 2))
        parts += [spoke.rotate([0, 0, 360.0 * k / n]) for k in range(n)]
    else:
        parts.append(prism(circle(1 - rim / 2), 0.4 * height, 0.6 * height))
    body = union(parts)
    if rng.chance(0.5):
        deep = 1 - 0.6 * rim
        groove = polygon([(deep, 0.4), (1.1, 0.1), (1.1, 0.9), (deep, 0.6)]).scale((1, height))
        body -= turned(groove)
    return body - _holes(1, 0, rng.uniform(0.4, 0.7) * hub)


def stepped_shaft(rng: Sampler) -> Manifold:
    """Steps that widen to the middle, with keyways, center holes and a flat."""
    count = rng.integer(3, 6)
    radii = np.sort(rng.uniforms(0.1, 0.32, count))
    radii = np.concatenate([radii[::2], radii[1::2][::-1]])
    levels = np.cumsum(np.r_[0, rng.uniforms(0.2, 0.8, count)])
    steps = zip(levels, levels[1:], radii, strict=False)
    corners = [corner for low, high, r in steps for corner in ((r, low), (r, high))]
    body = turned(fillet(turned_outline(np.array(corners)), 0.015, 0.02))
    for i in range(rng.integer(0, 2)):
        middle, length = (levels[i] + levels[i + 1]) / 2, 0.7 * (levels[i + 1] - levels[i])
        key = prism(slot(length, 0.3 * radii[i]), 0.75 * radii[i], 1.0)
        body -= key.rotate([0, 90, 0]).translate([0, 0, middle])
    return body - bore_tool(rng, 0.3 * radii[-1], 0.2).translate([0, 0, levels[-1]])


def ball_bearing(rng: Sampler) -> Manifold:
    """Two rings and a row of balls or rollers between."""
    height, bore = rng.uniform(0.25, 0.6), rng.uniform(0.4, 0.65)
    gap = 1 - bore
    inner, outer = bore + 0.33 * gap, bore + 0.67 * gap
    pitch, size = (inner + outer) / 2, 0.2 * gap
    rolling = Manifold.sphere(size, 20) if rng.chance(0.6) else cylinder(size, 0.8 * height)
    n = int(np.pi * pitch / size * rng.uniform(0.55, 0.9))
    row = [rolling.translate([x, y, height / 2]) for x, y in on_circle(n, pitch)]
    rings = prism(section_union([ring(inner, bore), ring(1, outer)]), 0, height)
    if rng.chance(0.3):
        return rings + prism(ring(1, bore), 0.1 * height, 0.9 * height)
    return union([rings, *row])


def motor_housing(rng: Sampler) -> Manifold:
    """A box or barrel with a foot, a shaft's collar and cooling ribs."""
    length, radius = rng.uniform(0.9, 1.8), rng.uniform(0.35, 0.55)
    barrel = circle(radius) if rng.chance(0.6) else rounded_rectangle(2 * radius, 2 * radius, 0.1)
    n = rng.integer(8, 24)
    rib = rectangle(1.12 * radius, 0.04, (0.56 * radius, 0))
    ribs = [rib.rotate(360.0 * k / n) for k in range(n)] if rng.chance(0.6) else []
    body = prism(section_union([barrel, *ribs]), 0, length)
    face = prism(rounded_rectangle(2.2 * radius, 2.2 * radius, 0.1), length - 0.1, length)
    bolt_holes = _holes(4, 1.3 * radius, 0.08 * radius).rotate([0, 0, 45])
    shaft = cylinder(0.2 * radius, 0.6, (0, 0, length + 0.2))
    parts = [body, face - bolt_holes, cylinder(0.5 * radius, 0.1, (0, 0, length)), shaft]
    if rng.chance(0.6):
        parts.append(block((0.1, 2.2 * radius, 0.6 * length), (-1.1 * radius, 0, 0.5 * length)))
        parts.append(block((0.4 * radius, 0.5 * radius, 0.3 * length), (radius, 0, 0.5 * length)))
    return union(parts)


def crank(rng: Sampler) -> Manifold:
    """Throws and webs along an axis, at half or third turns."""
    level, parts, step = 0.0, [], rng.pick((180.0, 120.0, 90.0))
    radius, throw = rng.uniform(0.12, 0.25), rng.uniform(0.2, 0.45)
    journal, web = rng.uniform(0.15, 0.4), rng.uniform(0.08, 0.2)
    arm = CrossSection.batch_hull([circle(1.5 * radius), circle(1.2 * radius, (throw, 0))])
    for i in range(rng.integer(1, 4)):
        parts.append(prism(circle(radius), level, level + journal + 0.01))
        level += journal
        crank_throw = [
            prism(arm, 0, web),
            prism(circle(0.9 * radius, (throw, 0)), web - 0.01, web + journal + 0.01),
            prism(arm, web + journal, 2 * web + journal),
        ]
        parts += [part.rotate([0, 0, step * i]).translate([0, 0, level]) for part in crank_throw]
        level += 2 * web + journal
    parts.append(prism(circle(radius), level - 0.01, level + 2 * journal))
    return union(parts)


def end_mill(rng: Sampler) -> Manifold:
    """A shank and helical flutes, as of a drill or a cutter."""
    radius, length = rng.uniform(0.12, 0.35), rng.uniform(0.6, 2.0)
    flutes, core = rng.integer(2, 5), circle(radius, segments=48)
    cuts = [circle(0.55 * radius, point, 16) for point in on_circle(flutes, 1.05 * radius)]
    fluted = (core - section_union(cuts)).extrude(length, 24, rng.uniform(90, 360))
    shank = rng.uniform(0.8, 1.5) * radius
    body = fluted + prism(circle(shank), length - 0.01, length + rng.uniform(0.4, 1.5))
    if rng.chance(0.4):
        body += prism(circle(1.3 * shank), length + 0.1, length + 0.25)
    return body


def valve_body(rng: Sampler) -> Manifold:
    """A bulb between two flanged ports, with a bonnet and a stem."""
    bulb, port = rng.uniform(0.35, 0.55), rng.uniform(0.15, 0.3)
    reach, collar = rng.uniform(0.7, 1.1), rng.uniform(1.3, 1.8) * port
    outer = Manifold.sphere(bulb, 36) if rng.chance(0.5) else cylinder(bulb, 1.6 * bulb)
    parts, bores = [outer], []
    for side in ("-x", "+x"):
        pipe = prism(circle(port), 0, reach) + prism(circle(collar), reach - 0.15, reach)
        parts.append(facing(side, pipe))
        bores.append(facing(side, prism(circle(0.7 * port), 0, reach + 1)))
    neck, stem = rng.uniform(0.4, 0.7) * bulb, rng.uniform(0.9, 1.5)
    parts += [
        prism(circle(neck), 0, 1.5 * bulb),
        prism(circle(1.4 * neck), 1.4 * bulb, 1.65 * bulb),
    ]
    parts.append(prism(circle(0.3 * neck), 0, stem + bulb))
    if rng.chance(0.6):
        parts.append(prism(ring(0.5, 0.4), stem + bulb - 0.1, stem + bulb))
        parts += [
            block((0.9, 0.08, 0.06), (0, 0, stem + bulb - 0.06)).rotate([0, 0, a]) for a in (0, 90)
        ]
    return union(parts) - union(bores)
