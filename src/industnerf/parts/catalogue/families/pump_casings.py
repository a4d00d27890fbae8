"""Casings of centrifugal pumps."""

import math

from build123d import Circle, Plane, Pos, Rot, Shape, Sketch, loft

from industnerf.parts.catalogue.families.drawing import (
    bar,
    block,
    on_circle,
    on_grid,
    raised_flange,
    rod,
    rods,
    rounded_block,
)
from industnerf.parts.catalogue.recipe import MeshBoolean, Recipe


def pump_casing(impeller: float, throat: float, suction: float, wall: float) -> MeshBoolean:
    """Volute of a centrifugal pump, its axis along y: suction in front, delivery straight up.

    Open behind, where impeller and back cover go in.
    """
    chamber, depth = 1.08 * impeller, 0.3 * impeller  # where the impeller turns
    drum, delivery, inlet = chamber + 4 * wall, 1.05 * impeller, 0.62 * impeller
    inner = chamber / 2 - 4.0  # radius that the scroll touches: it opens into the chamber
    center = inner + throat / 2  # of the throat
    foot_level = -0.95 * impeller

    # drawn about z, suction up, delivery towards +y
    def passage(extra: float, length: float) -> list[Shape]:
        """Scroll and delivery branch, their walls `extra` outside the water's way."""
        straight = Plane((center, -1, 0), z_dir=(0, 1, 0)) * rod(throat + 2 * extra, length)
        return [loft(_scroll(inner, throat / 2, extra), ruled=True), straight]

    outlet = raised_flange(2.9 * throat, 14.0, 2.2 * throat, 4, 14.0)
    mouth = raised_flange(2.6 * suction, 14.0, 2.0 * suction, 4, 14.0)
    rear = rod(drum + 26, 12.0, (0, 0, -depth / 2 - wall))
    rear -= rods(on_circle(8, drum + 10, 22.5), 7.0, 12.0, -depth / 2 - wall)
    foot = block(0.16 * impeller, -foot_level, 0.5 * depth, (0, foot_level / 2, -0.25 * depth))
    foot += rounded_block(
        1.3 * impeller, 12.0, 0.7 * impeller, 4.0, (0, foot_level, -0.35 * impeller)
    )
    join = [
        *passage(wall, delivery),
        rod(drum, depth + 2 * wall, (0, 0, -depth / 2 - wall)),
        rear,
        rod(suction + 2 * wall, inlet),
        Pos(0, 0, inlet) * Rot(180, 0, 0) * mouth,
        Pos(center, delivery, 0) * Rot(90, 0, 0) * outlet,
        foot,
    ]
    anchors = [(x, foot_level, z) for x, z in on_grid(0.95 * impeller, 0.42 * impeller)]
    cut = [
        *passage(0.0, delivery + 2),
        rod(chamber, depth + wall + 1, (0, 0, -depth / 2 - wall - 1)),
        rod(suction, inlet + 1),
        *[bar(11.0, 40.0, "y", anchor) for anchor in anchors],
    ]
    upright = Rot(90, 0, 0)
    return MeshBoolean([upright * body for body in join], [upright * body for body in cut])


def _scroll(inner: float, throat: float, extra: float) -> list[Sketch]:
    """Circles about the z axis that touch radius `inner` and grow to `throat` at the end."""
    sections = []
    for turn in range(24, 361, 14):
        radius, angle = throat * (0.25 + 0.75 * turn / 360), math.radians(turn)
        outward = (math.cos(angle), math.sin(angle), 0)
        onward = (-math.sin(angle), math.cos(angle), 0)
        reach = inner + radius
        plane = Plane((reach * outward[0], reach * outward[1], 0), x_dir=outward, z_dir=onward)
        sections.append(plane * Circle(radius + extra))
    return sections


RECIPES = [
    Recipe(
        "pump-casing-d100",
        "volute casing of an end-suction pump, impeller 100, outlet 38",
        "build123d",
        pump_casing,
        {"impeller": 100.0, "throat": 38.0, "suction": 50.0, "wall": 6.0},
        finish="yellow paint",
    )
]
