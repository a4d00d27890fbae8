"""Fans and blowers."""

from build123d import (
    Circle,
    Pos,
    Rectangle,
    Rot,
    Shape,
    extrude,
    loft,
)

from industnerf.parts.catalogue.families.blades import blade_section
from industnerf.parts.catalogue.families.drawing import (
    Real,
    copies_on_circle,
    fused,
    rod,
    tube,
    turned,
)
from industnerf.parts.catalogue.recipe import Assembly, Recipe


def axial_fan(diameter: Real, height: Real, blades: int, bore: Real) -> Assembly:
    """Molded axial fan: twisted airfoil blades from the hub to a ring, a brass bush."""
    outer = diameter / 2
    inner, hub, wall = 0.92 * outer, 0.31 * outer, 0.03 * outer
    stations = [(0.26, 50, 0.33, 0.06), (0.6, 36, 0.41, 0.06), (0.925, 24, 0.43, 0.06)]
    blade = loft([blade_section(r * outer, a, c * outer, 0.1, m) for r, a, c, m in stations])
    blade = Pos(0, 0, height / 2) * blade
    low, lip = -0.02 * diameter, 0.06 * outer
    ring = turned(
        [
            (inner, 0),
            (outer, 0),
            (outer, wall),
            (inner + wall, lip),
            (inner + wall, height),
            (inner, height),
        ]
    )
    cup = turned(
        [(0, low), (0.9 * hub, low), (hub, 0.1 * hub), (hub, 1.1 * height), (0, 1.1 * height)]
    )
    hollow = tube(2 * (hub - 2 * wall), 2.4 * bore, height, (0, 0, 0.25 * height))
    bush = tube(1.6 * bore, bore, 1.2 * height - low, (0, 0, low - 1))
    return Assembly(
        {
            "black plastic": fused([ring, cup, *copies_on_circle(blades, blade)])
            - hollow
            - rod(1.6 * bore, 3 * height, (0, 0, -height)),
            "brass": bush,
        }
    )


def blower_wheel(diameter: Real, width: Real, blades: int, bore: Real) -> Shape:
    """Drum fan of sheet: short forward-curved blades between a back plate and a ring."""
    outer, sheet = diameter / 2, 0.012 * diameter
    inner, bend = 0.84 * outer, 0.17 * outer  # where the blades begin, and their radius
    arc = Circle(bend + sheet / 2) - Circle(bend - sheet / 2)
    arc &= Pos(0, bend) * Rectangle(4 * bend, 2 * bend)  # its upper half
    strip = Pos(0.92 * outer, -0.7 * bend) * Rot(0, 0, -12) * arc
    blade = extrude(strip & (Circle(0.99 * outer) - Circle(inner)), width - sheet / 2)
    hub, dish = 1.6 * bore, 0.25 * width
    plate = turned(
        [
            (0, dish),
            (1.5 * hub, dish),
            (2.5 * hub, 0),
            (outer, 0),
            (outer, sheet),
            (2.6 * hub, sheet),
            (1.6 * hub, dish + sheet),
            (0, dish + sheet),
        ]
    )
    ring = tube(diameter, 1.9 * inner, sheet, (0, 0, width - sheet))
    boss = rod(hub, 0.75 * width - dish, (0, 0, dish))
    return fused([plate, ring, boss, *copies_on_circle(blades, blade)]) - rod(bore, 2 * width)


RECIPES = [
    Recipe(
        "fan-axial-d160",
        "axial fan D160 in a ring, 7 blades",
        "build123d",
        axial_fan,
        {"diameter": 160.0, "height": 24.0, "blades": 7, "bore": 8.0},
    ),
    Recipe(
        "blower-wheel-d120",
        "forward-curved blower wheel D120x50, 36 blades",
        "build123d",
        blower_wheel,
        {"diameter": 120.0, "width": 50.0, "blades": 36, "bore": 10.0},
        finish="zinc",
    ),
]
