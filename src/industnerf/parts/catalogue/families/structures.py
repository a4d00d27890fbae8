"""Profiles, plates and panels of frames and machines."""

from bd_warehouse.open_builds import CBeamGantryPlateXLarge, RouterSpindleMount, VSlotLinearRail
from build123d import Axis, Pos, Rot, Shape, Sphere, fillet

from industnerf.parts.catalogue.families.drawing import bar, bent_sheet, block, on_grid, rods
from industnerf.parts.catalogue.recipe import MeshBoolean, Recipe


def gantry_plate() -> Shape:
    """C-Beam gantry plate XLarge, as OpenBuilds sells it."""
    return CBeamGantryPlateXLarge()


def spindle_mount() -> Shape:
    """Router spindle mount, base and face plate, as OpenBuilds sells it."""
    return RouterSpindleMount("both")


def v_slot(profile: str, length: float) -> Shape:
    """OpenBuilds V-slot rail."""
    return VSlotLinearRail(profile, length)


def wide_flange_beam(
    depth: float, width: float, web: float, flange: float, root: float, length: float
) -> Shape:
    """A length of HE section of EN 10365 along z, bored through web and flanges for its joints."""
    beam = block(web, depth, length)
    for y in (1, -1):
        beam += block(width, flange, length, (0, y * (depth - flange) / 2, 0))
    roots = beam.edges().filter_by(Axis.Z).sort_by_distance((0, 0, length / 2))[:4]
    beam = fillet(roots, root)
    gauge, ends = 0.56 * width, (0.15 * length, 0.85 * length)  # between and along rows of bolts
    beam -= [bar(13.0, 2 * depth, "y", (s * gauge / 2, 0, z)) for s in (1, -1) for z in ends]
    return beam - [bar(0.38 * depth, width, "x", (0, 0, z * length)) for z in (0.25, 0.5, 0.75)]


def louvered_panel(length: float, width: float, sheet: float, louvers: int) -> MeshBoolean:
    """Sheet-metal cover: edges folded down along x, pressed louvers that open towards -y."""
    fold, bend, hood, pitch = 15.0, 2.5, 8.0, 0.72 * width / louvers
    half, low = (width - sheet) / 2, -sheet / 2
    path = [(-half, -fold), (-half, low), (half, low), (half, -fold)]
    panel = Rot(0, 0, 90) * bent_sheet(path, sheet, bend, length)

    def bulge(radius: float, y: float, front: float) -> Shape:
        """A bar with round ends, from `front` before its middle at `y` backwards."""
        reach = 0.33 * length - hood
        ends = [Pos(side * reach, 0, 0) * Sphere(radius) for side in (1, -1)]
        body = bar(2 * radius, 2 * reach, "x") + ends
        body &= block(length, hood + front, 2 * hood, (0, (hood - front) / 2, -hood))
        return Pos(0, y, 0) * body

    rows = [(i - louvers / 2 + 0.3) * pitch for i in range(louvers)]
    outside = block(length, width, 2 * hood, (0, 0, -sheet / 2))  # rooted in the panel
    hoods = [bulge(hood, y, 0.0) & outside for y in rows]
    openings = [bulge(hood - sheet, y, sheet) for y in rows]
    screws = rods(on_grid(0.88 * length, 0.8 * width), 4.5, 2 * sheet, -1.5 * sheet)
    return MeshBoolean(join=[panel, *hoods], cut=[*openings, *screws])


RECIPES = [
    Recipe(
        "beam-he100b",
        "EN 10365 HE 100 B, length 200, bored",
        "build123d",
        wide_flange_beam,
        {"depth": 100.0, "width": 100.0, "web": 6.0, "flange": 10.0, "root": 12.0, "length": 200.0},
        finish="red paint",
    ),
    Recipe(
        "gantry-plate-c-beam-xl",
        "OpenBuilds C-Beam gantry plate XLarge",
        "bd_warehouse",
        gantry_plate,
        {},
        finish="aluminum",
    ),
    Recipe(
        "panel-louvred-140x100",
        "louvered sheet-metal cover 140x100, 4 louvers",
        "build123d",
        louvered_panel,
        {"length": 140.0, "width": 100.0, "sheet": 1.5, "louvers": 4},
        finish="gray paint",
    ),
    Recipe(
        "spindle-mount-openbuilds",
        "OpenBuilds router spindle mount",
        "bd_warehouse",
        spindle_mount,
        {},
        finish="aluminum",
    ),
    Recipe(
        "v-slot-20x80",
        "OpenBuilds V-slot 20x80, length 150",
        "bd_warehouse",
        v_slot,
        {"profile": "20x80", "length": 150.0},
        finish="aluminum",
    ),
]
