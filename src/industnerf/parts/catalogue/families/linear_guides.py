"""A profile rail guide and a trapezoidal screw.

Rail and carriage run along y; z counts from the bottom of the rail.
"""

from bd_warehouse.thread import MetricTrapezoidalThread
from build123d import Circle, Plane, Pos, Rot, Shape, Sketch, extrude, offset

from industnerf.parts.catalogue.families.drawing import (
    Point,
    Real,
    bar,
    chamfered_rod,
    fused,
    on_circle,
    on_grid,
    polygon,
    rod,
    rods,
    turned,
)
from industnerf.parts.catalogue.recipe import Assembly, MeshBoolean, Recipe


def mirrored(side: list[Point]) -> Sketch:
    """The polygon over (x, z) whose right side, from the bottom to the top, is `side`."""
    return polygon(side + [(-x, z) for x, z in reversed(side)])


def along_y(section: Sketch, length: Real, middle: Real = 0) -> Shape:
    """A section over (x, z) drawn out to both sides of y = `middle`."""
    return Pos(0, middle, 0) * extrude(Plane.XZ * section, length / 2, both=True)


def rail_section(width: Real, height: Real) -> Sketch:
    """Foot, waist and head of a rail, the edges of foot and head broken."""
    half, waist, edge = 0.5 * width, 0.37 * width, 0.03 * width
    foot = [(half - edge, 0), (half, edge), (half, 0.2 * height), (waist, 0.36 * height)]
    head = [(waist, 0.66 * height), (half, 0.82 * height), (half, height - edge)]
    return mirrored([*foot, *head, (half - edge, height)])


def profile_rail(width: Real, height: Real, ball: Real, pitch: Real, holes: int) -> Shape:
    """Rail with four ball tracks in its flanks; counterbored for an M5 screw every `pitch`."""
    section = rail_section(width, height)
    flanks = [(0.435 * width + 0.25 * ball, z * height) for z in (0.34, 0.68)]
    section -= [Pos(s * x, z) * Circle(ball / 2) for s in (1, -1) for x, z in flanks]
    span = pitch * (holes - 1)
    rail = along_y(section, span + 2 * width)
    drilled = [(0, pitch * i - span / 2) for i in range(holes)]
    head, depth = 9.5, 8.5
    return rail - rods(drilled, 6.0, height) - rods(drilled, head, depth, height - depth)


def carriage(
    rail: Real, rail_height: Real, width: Real, gap: Real, height: Real, block: Real, length: Real
) -> Assembly:
    """Block carriage for `profile_rail`: steel block, plastic end caps, wipers, grease nipple.

    `gap` is that between the carriage and the plane of the rail's foot.
    """
    wiper, bite = 1.5, 1.0  # the slices reach into each other by `bite`
    cap = 0.5 * (length - block) - wiper

    def slice_of(shrink: Real, clearance: Real) -> Sketch:
        half, low, high = width / 2 - shrink, gap + shrink, height - shrink
        edge = 0.03 * width
        side = [(half - edge, low), (half, low + edge), (half, high - edge), (half - edge, high)]
        return mirrored(side) - offset(rail_section(rail, rail_height), clearance)

    ends = [(s, s * (block + cap - bite) / 2, s * (length - wiper - bite) / 2) for s in (1, -1)]
    steel = along_y(slice_of(0, 0.8), block)
    steel -= rods(on_grid(0.73 * width, 0.7 * block), 5.0, 6.0, height - 6.0)
    caps = [along_y(slice_of(0.8, 1.0), cap + bite, y) for _, y, _ in ends]
    screws = [(x, s * length / 2 - s, 0.72 * height) for s, _, _ in ends for x in (-16, 16)]
    wipers = [along_y(slice_of(1.6, 0.4), wiper + bite, y) for _, _, y in ends]
    heads = [bar(5.0, 3.0, "y", at) for at in screws]
    recesses = [bar(6.5, 5.0, "y", at) for at in screws]
    nipple = turned([(0, 0), (3, 0), (3, 4), (1.6, 4.5), (1.6, 6), (2.3, 7), (1.2, 9), (0, 9)])
    return Assembly(
        {
            "steel": steel,
            "green paint": fused(caps),
            "rubber": fused(wipers) - recesses,
            "black oxide": fused(heads),
            "brass": Pos(0, length / 2 - 1, 0.82 * height) * Rot(-90, 0, 0) * nipple,
        }
    )


def trapezoidal_screw(size: str, length: Real, journal: Real, nut: Real, flange: Real) -> Assembly:
    """Trapezoidal screw standing on a turned journal, with a flanged bronze nut on it.

    The thread is bd_warehouse's: its core is half a pitch deep, without the clearance of ISO 2904.
    """
    thread = MetricTrapezoidalThread(size, length, end_finishes=("chamfer", "chamfer"))
    core, base, plate = 2 * thread.root_radius, 0.3 * length, 0.27 * nut
    shaft = chamfered_rod(journal, 1.5 * core + 2, 0.8, (0, 0, -1.5 * core))
    outline = [(0, 0), (flange / 2, 0), (flange / 2, plate), (nut / 2, plate), (nut / 2, 1.1 * nut)]
    bush = Pos(0, 0, base) * turned([*outline, (0, 1.1 * nut)])
    bolts = rods(on_circle(6, (nut + flange) / 2), 0.12 * flange, 2 * plate, base - plate / 2)
    return Assembly(
        {
            "bright steel": MeshBoolean([*thread.solids(), rod(core, length), shaft], []),
            "bronze": bush - bolts,
        }
    )


RECIPES = [
    Recipe(
        "rail-hgr20-160",
        "profile rail HGR20-like, 160 long",
        "build123d",
        profile_rail,
        {"width": 20.0, "height": 17.5, "ball": 3.2, "pitch": 60.0, "holes": 3},
    ),
    Recipe(
        "carriage-hgh20ca",
        "rail carriage HGH20CA-like",
        "build123d",
        carriage,
        {
            "rail": 20.0,
            "rail_height": 17.5,
            "width": 44.0,
            "gap": 4.6,
            "height": 30.0,
            "block": 50.5,
            "length": 77.5,
        },
    ),
    Recipe(
        "screw-trapezoidal-tr16x4",
        "ISO 2904 Tr16x4-like screw, 100 long, with a flanged bronze nut",
        "bd_warehouse",
        trapezoidal_screw,
        {"size": "16x4", "length": 100.0, "journal": 10.0, "nut": 28.0, "flange": 48.0},
    ),
]
