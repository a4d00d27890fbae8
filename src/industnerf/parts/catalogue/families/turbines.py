"""Blades and discs of turbines."""

from build123d import (
    Plane,
    Pos,
    Rot,
    Shape,
    Sketch,
    extrude,
    fillet,
    loft,
)

from industnerf.parts.catalogue.families.blades import airfoil_face, blade_section
from industnerf.parts.catalogue.families.drawing import (
    Real,
    block,
    copies_on_circle,
    fused,
    on_circle,
    polygon,
    rods,
    turned,
)
from industnerf.parts.catalogue.recipe import MeshBoolean, Recipe


def fir_tree(width: Real, depth: Real, lobes: int) -> Sketch:
    """Root of a turbine blade over (x, z), its top at z = 0: lobes that narrow downwards."""
    side = [(width / 2, 0.0)]
    for i in range(lobes):
        shrink, low = 1 - i / (lobes + 0.7), -depth * i / lobes
        step = depth / lobes
        lobe = [(0.32, 0.3), (0.32, 0.45), (0.46, 0.75), (0.44, 1.0)]
        side += [(x * width * shrink, low - z * step) for x, z in lobe]
    outline = polygon(side + [(-x, z) for x, z in reversed(side)])
    rounded = [v for v in outline.vertices() if v.Y < -0.1]
    return fillet(rounded, 0.035 * width)


def turbine_blade(height: Real, chord: Real, root: Real, lobes: int) -> Shape:
    """Rotor blade of a gas turbine: fir-tree root, platform, twisted airfoil, tip shroud."""
    stations = [(-0.01, 0, 1, 0.17, 0.2), (0.35, 10, 0.93, 0.15, 0.17)]
    stations += [(0.7, 22, 0.84, 0.12, 0.13), (1.02, 33, 0.74, 0.1, 0.09)]
    sections = [
        Pos(0, -camber * c * chord / 2, z * height)
        * Rot(0, 0, turn)
        * airfoil_face(c * chord, thick, camber)
        for z, turn, c, thick, camber in stations
    ]
    platform, shroud, length = 0.16 * chord, 0.07 * chord, 1.1 * chord
    foot = extrude(Plane.YZ * fir_tree(root, 1.3 * root, lobes), length / 2, both=True)
    seal = block(0.05 * chord, 0.66 * chord, 2.2 * shroud)
    return fused(
        [
            loft(sections),
            Pos(0, 0, 0.5 - platform) * foot,
            block(1.15 * length, 0.8 * chord, platform, (0, 0, -platform)),
            Rot(0, 0, 33) * block(0.86 * chord, 0.6 * chord, shroud, (0, 0, height)),
            *[Rot(0, 0, 33) * Pos(x * chord, 0, height) * seal for x in (-0.2, 0.2)],
        ]
    )


def bladed_disc(diameter: Real, blades: int, bore: Real) -> MeshBoolean:
    """Disc and blades of one piece: a thick bore, a thin web, a rim that carries the blades.

    United as meshes: OpenCASCADE takes half a minute.
    """
    outer = diameter / 2
    rim, width = 0.7 * outer, 0.2 * outer
    half = [
        (bore / 2, 0.75 * width),
        (0.25 * outer, 0.75 * width),
        (0.29 * outer, 0.28 * width),
        (0.6 * outer, 0.2 * width),
        (0.65 * outer, 0.5 * width),
        (rim, 0.5 * width),
    ]
    disc = turned(half + [(r, -z) for r, z in reversed(half)])
    stations = [(0.68, 62, 0.2), (0.84, 52, 0.19), (1.0, 42, 0.18)]
    blade = loft([blade_section(r * outer, a, c * outer, 0.12, 0.14) for r, a, c in stations])
    bolts = rods(on_circle(8, 0.43 * diameter), 0.04 * diameter, diameter, -outer)
    return MeshBoolean([disc, *copies_on_circle(blades, blade)], bolts)


RECIPES = [
    Recipe(
        "turbine-blade-115",
        "gas turbine rotor blade, 115 high, fir-tree root",
        "build123d",
        turbine_blade,
        {"height": 115.0, "chord": 44.0, "root": 24.0, "lobes": 3},
    ),
    Recipe(
        "bladed-disc-d200-30",
        "bladed disc D200, 30 blades",
        "build123d",
        bladed_disc,
        {"diameter": 200.0, "blades": 30, "bore": 30.0},
    ),
]
