"""Exhaust manifold and spark plug."""

from build123d import Plane, RectangleRounded, Shape, Spline, Wire, extrude, sweep

from industnerf.parts.catalogue.families.drawing import (
    Real,
    block,
    faced_hexagon,
    fused,
    on_circle,
    rod,
    rods,
    round_section,
    threaded,
    tube,
    turned,
)
from industnerf.parts.catalogue.recipe import Assembly, MeshBoolean, Recipe


def pipe_run(start: Real, end: tuple[Real, Real], height: Real, diameter: Real) -> Shape:
    """A round bar that leaves (start, 0, 2) upwards and reaches `end` at `height` upwards."""
    path = Spline((start, 0, 2), (*end, height), tangents=((0, 0, 1), (0, 0, 1)))
    section = Plane(path @ 0, x_dir=(1, 0, 0), z_dir=(0, 0, 1)) * round_section(diameter)
    return sweep(section, path=Wire([path.edge()]))


def exhaust_manifold(pitch: Real, height: Real, pipe: Real, wall: Real, outlet: Real) -> Assembly:
    """Four pipes of sheet from one flange into a collector; the outlet's flange has three holes.

    The pipes are united and bored as meshes: OpenCASCADE takes a minute.
    """
    plate, merge = 10.0, 0.45 * pipe  # half the pipes' distance in the collector
    ports = [(i - 1.5) * pitch for i in range(4)]
    ends = [(-merge, merge), (-merge, -merge), (merge, -merge), (merge, merge)]
    runs = list(zip(ports, ends, strict=True))
    outside = [pipe_run(x, end, height, pipe) for x, end in runs]
    bores = [pipe_run(x, end, height, pipe - 2 * wall) for x, end in runs]
    bores += rods([(x, 0) for x in ports], pipe - 2 * wall + 0.5, 4)
    # flanges are bored narrower than the pipes that stand in them: no surfaces coincide
    mouths = rods([(x, 0) for x in ports], pipe - 2 * wall - 1, plate + 2, -1)

    def cone(inset: Real) -> Shape:
        wide, narrow = 2.42 * merge + pipe / 2 - 8 - inset, outlet / 2 - inset
        low, middle, top = height - 6 + inset, height + 30, height + 80
        profile = [(0, low), (wide, low), (wide, height + 6), (narrow, middle), (narrow, top)]
        return turned([*profile, (0, top)])

    flange = extrude(RectangleRounded(4 * pitch - 6, 1.9 * pipe, 12), plate)
    studs = [(x * pitch, s * 0.7 * pipe) for x in (-1.85, -1, 0, 1, 1.85) for s in (1, -1)]
    rim = tube(1.9 * outlet, outlet - 2 * wall - 1, plate, (0, 0, height + 78))
    rim -= rods(on_circle(3, 1.5 * outlet), 9, plate, height + 78)
    return Assembly(
        {
            "bright steel": MeshBoolean([*outside, cone(0)], [*bores, cone(wall)]),
            "cast iron": fused([flange, rim]) - mouths - rods(studs, 9, plate + 2, -1),
        }
    )


def insulator(thread: Real, reach: Real, top: Real) -> Shape:
    """Ceramic of a spark plug: five ribs below `top`, a nose down into the shell."""
    neck, nose, tip, pitch = 0.37 * thread, 0.45 * thread, -reach - 1, 2.2
    rib = [(neck, 0.0), (neck - 0.7, 0.7), (neck - 0.7, 1.5)]
    ribs = [(radius, top + (i - 5) * pitch + z) for i in range(5) for radius, z in rib]
    ceramic = turned([(0, 0), (neck, 0), *ribs, (0.8 * neck, top), (0, top)])
    cone = [(0, tip), (0.18 * thread, tip), (nose, -0.3 * reach), (nose, 1), (0, 1)]
    return ceramic + turned(cone)


def electrodes(thread: Real, reach: Real, top: Real) -> list[Shape]:
    """The terminal's nut, the center electrode, and the strap from the shell to under its tip."""
    gap, strap, width, tip = 0.9, 1.4, 2.8, -reach - 3.0
    low, edge, waist, nut = tip - gap - strap, 0.43 * thread, 2.2, 3.2
    outline = [(0, top - 1), (waist, top - 1), (waist, top + 2), (nut, top + 2.5)]
    terminal = turned([*outline, (nut, top + 6), (2, top + 8), (0, top + 8)])
    leg = block(strap, width, 6, (edge, 0, low))
    foot = block(edge + 2, width, strap, (edge / 2, 0, low))
    return [terminal, rod(2.5, reach, (0, 0, tip)), leg, foot]


def spark_plug(thread: Real, pitch: Real, reach: Real, hexagon: Real) -> Assembly:
    """Flat-seat spark plug, electrodes down, its seat on z = 0; the thread is drawn as rings."""
    top, crimp, face = 2.4 * thread, 1.2 * hexagon, 0.48 * hexagon
    seat = turned([(0, 0), (0.65 * thread, 0), (0.68 * thread, 3), (0.5 * thread, 3.5), (0, 3.5)])
    collar = turned([(0, 3), (face, 3), (face, hexagon), (0.75 * face, crimp), (0, crimp)])
    shell = [threaded(thread, pitch, reach, (0, 0, -reach)), seat, collar]
    shell += [faced_hexagon(hexagon, 0.7 * hexagon, (0, 0, 3)), rod(thread - 2, 3, (0, 0, -2))]
    hollow = rod(0.7 * thread, 0.7 * reach + 1, (0, 0, -reach - 1))
    return Assembly(
        {
            "zinc": fused(shell) - hollow,
            "white plastic": insulator(thread, reach, top),
            "bright steel": fused(electrodes(thread, reach, top)),
            "copper": tube(1.4 * thread, thread - 2.2, 2, (0, 0, -1.8)),
        }
    )


RECIPES = [
    Recipe(
        "exhaust-manifold-4-1",
        "tubular 4-1 exhaust manifold, pipes d38, pitch 92",
        "build123d",
        exhaust_manifold,
        {"pitch": 92.0, "height": 190.0, "pipe": 38.0, "wall": 2.0, "outlet": 54.0},
    ),
    Recipe(
        "spark-plug-m14x19",
        "spark plug M14x1.25, reach 19, hexagon 16, ISO 1919-like",
        "build123d",
        spark_plug,
        {"thread": 14.0, "pitch": 1.25, "reach": 19.0, "hexagon": 16.0},
    ),
]
