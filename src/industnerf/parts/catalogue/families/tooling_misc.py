"""Hand tools and clamps; also `tool_holders` and small `hardware`."""

from build123d import Circle, Plane, Pos, Rot, Shape, Sketch, chamfer, extrude

from industnerf.parts.catalogue.families import hardware, tool_holders
from industnerf.parts.catalogue.families.drawing import (
    Point,
    bar,
    block,
    faced_hexagon,
    hexagon,
    on_grid,
    rod,
    rods,
    tangent_hull,
    threaded,
    turned,
    upright,
)
from industnerf.parts.catalogue.recipe import Assembly, MeshBoolean, Recipe


def combination_spanner(size: float, length: float) -> Shape:
    """Combination spanner, proportions after DIN 3113 A: jaw at the origin, ring along -x."""
    jaw_head, jaw_thick, jaw_angle = 2.15 * size, 0.47 * size, 15.0
    ring_head, ring_thick = 1.53 * size, 0.62 * size
    shank_thick, recess = 0.34 * size, 0.05 * size
    clearance = 1.012 * size
    ring_x = -(length - jaw_head / 2 - ring_head / 2)

    def plate(sketch: Sketch, thickness: float) -> Shape:
        return extrude(sketch, thickness / 2, both=True)

    near, far = (-0.45 * jaw_head, 0.0), (ring_x + 0.4 * ring_head, 0.0)
    spanner = plate(Circle(jaw_head / 2), jaw_thick)
    spanner += plate(tangent_hull(near, 0.43 * size, far, 0.36 * size), shank_thick)
    spanner += Pos(ring_x, 0, -ring_thick / 2) * rod(ring_head, ring_thick)
    # the nut's seat: two parallel flats that end in half a hexagon
    mouth = hexagon(clearance, 2 * jaw_thick) + block(
        jaw_head, clearance, 2 * jaw_thick, (jaw_head / 2, 0, 0)
    )
    spanner -= Pos(0, 0, -jaw_thick) * Rot(0, 0, jaw_angle) * mouth
    spanner -= [
        Pos(ring_x, 0, -ring_thick) * Rot(0, 0, turn) * hexagon(clearance, 2 * ring_thick)
        for turn in (0, 30)
    ]
    panel = tangent_hull(
        (-0.95 * jaw_head, 0), 0.25 * size, (ring_x + 1.05 * ring_head, 0), 0.2 * size
    )
    for side in (1, -1):
        spanner -= Pos(0, 0, side * shank_thick / 2) * plate(panel, 2 * recess)
    return spanner


def toggle_clamp(reach: float, height: float) -> Assembly:
    """Hold-down toggle clamp with an upright handle, drawn closed; the arm points along +x.

    Pivots lie along y: `front` and `back` in the base, `knee` and `crank` in the handle.
    """
    front, back, knee, crank = (16.0, 28.0), (-20.0, 16.0), (-2.0, 34.0), (-12.0, 52.0)
    sheet = 3.0
    arm_y, link_y, cheek_y = 4.5, 7.4, 10.3  # of the plates, which come in pairs

    def pair(start: Point, stop: Point, radius: float, y: float) -> list[Shape]:
        """Two straps between two pivots, one at each side."""
        return [_strap(start, stop, radius, sheet, side * y) for side in (1, -1)]

    plates = [block(64.0, 50.0, sheet, (-2.0, 0, 0))]
    cheek = [
        (-30, 0),
        (26, 0),
        (26, 16),
        (front[0] + 6, 36),
        (front[0] - 6, 36),
        (-14, 24),
        (-30, 18),
    ]
    plates += [upright(cheek, sheet, side * cheek_y) for side in (1, -1)]
    plates += pair(knee, front, 6.0, arm_y) + pair(front, (reach, front[1]), 6.0, arm_y)
    plates += pair(back, crank, 5.0, link_y)
    top, grip_start = (-14.0, height), (-7.0, (knee[1] + height) / 2 - 12)
    plates += [_strap(knee, top, 6.0, 5.6, 0.0)]
    holes = rods([(x - 2, y) for x, y in on_grid(50.0, 36.0)], 6.2, 3 * sheet, -sheet)
    rivets = [
        bar(5.0, 2 * y + 7, "y", (x, 0, z))
        for (x, z), y in ((front, cheek_y), (back, cheek_y), (knee, arm_y + 1), (crank, link_y))
    ]
    foot = reach - 8.0
    spindle = threaded(8.0, 1.25, front[1] + 24, (foot, 0, 6))
    spindle += [faced_hexagon(13.0, 6.5, (foot, 0, z)) for z in (front[1] + 5.8, front[1] - 12.3)]
    pad = turned([(0, 0), (9, 0), (8, 5), (5.5, 11), (0, 11)])
    grip = _strap(grip_start, top, 8.0, 15.0, 0.0)
    return Assembly(
        {
            "zinc": MeshBoolean(plates, holes),
            "bright steel": MeshBoolean(rivets, []),
            "black oxide": spindle,
            "rubber": Pos(foot, 0, 0) * pad,
            "red paint": chamfer(grip.edges(), 2.5),
        }
    )


def _strap(start: Point, stop: Point, radius: float, thickness: float, center_y: float) -> Shape:
    """A flat bar with round ends between two points of (x, z)."""
    outline = Plane.XZ * tangent_hull(start, radius, stop, radius)
    return Pos(0, center_y, 0) * extrude(outline, thickness / 2, both=True)


RECIPES = [
    Recipe(
        "spanner-din3113-17",
        "DIN 3113 A 17-like",
        "build123d",
        combination_spanner,
        {"size": 17.0, "length": 200.0},
        finish="bright steel",
    ),
    Recipe(
        "toggle-clamp-vertical",
        "toggle clamp with upright handle, spindle M8",
        "build123d",
        toggle_clamp,
        {"reach": 80.0, "height": 130.0},
    ),
    *tool_holders.RECIPES,
    *hardware.RECIPES,
]
