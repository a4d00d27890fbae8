"""Internal gears, and gears in company: a planetary set, a clock wheel with its pinion."""

import py_gearworks
from bd_warehouse.gear import SpurGear
from build123d import Compound, Pos, Rot, Shape, extrude

from industnerf.parts.catalogue.families.drawing import (
    Real,
    block,
    chamfered_rod,
    copies_on_circle,
    fused,
    keyed_bore,
    on_circle,
    rod,
    rods,
    tangent_hull,
    tube,
)
from industnerf.parts.catalogue.recipe import Assembly, Recipe


def ring_gear(module: Real, teeth: int, width: Real, bolts: int, bolt_hole: Real) -> Shape:
    """Internal gear of 20 degrees, bolted through its rim."""
    rim = 8.0  # modules from the pitch circle to the outside
    ring = py_gearworks.SpurRingGear(
        teeth, height=width, module=module, outside_ring_coefficient=rim
    ).build_part()
    bolt_circle = module * (teeth + 1.2 * rim)
    return ring - rods(on_circle(bolts, bolt_circle), bolt_hole, 2 * width, -width / 2)


def planetary_set(module: Real, sun: int, planet: int, width: Real, pin: Real) -> Assembly:
    """A sun in a ring, three planets between them on the pins of a carrier below."""
    planets, axes = 3, module * (sun + planet)  # the diameter of the planets' circle
    clearance, plate, bush = 1.0, 0.5 * width, 1.6 * pin
    backlash = 0.1  # mm: the planets' teeth are that much thinner, and so touch nothing
    ring = ring_gear(module, sun + 2 * planet, width, 6, 3 * module)
    # on +x the ring holds a space and the planet a tooth, hence the sun a space
    sun_gear = Pos(0, 0, width / 2) * Rot(0, 0, 180 / sun) * SpurGear(module, sun, 20, width)
    sun_gear -= keyed_bore(0.35 * module * sun, 0.1 * module * sun, width)
    planet_gear = py_gearworks.SpurGear(
        planet, height=width, module=module, backlash=backlash / module
    ).build_part()
    at_pin = Pos(axes / 2, 0, 0)
    planet_gear = at_pin * (planet_gear - rod(bush, width))
    lining = at_pin * tube(bush, pin, width)
    low, high, shoulder = -plate - clearance, width + clearance, (pin + bush) / 2
    axle = rod(pin, high - low, (0, 0, low)) + rod(bush, clearance, (0, 0, -clearance))
    axle = at_pin * (axle + rod(shoulder, clearance, (0, 0, width)))
    arm = extrude(tangent_hull((0, 0), 0.35 * axes, (axes / 2, 0), 1.1 * bush), plate)
    eye = rod(0.4 * axes, 2 * plate, (0, 0, low - plate / 2))
    return Assembly(
        {
            "steel": Compound([ring, *copies_on_circle(planets, planet_gear)]),
            "bright steel": Compound([sun_gear, *copies_on_circle(planets, axle)]),
            "bronze": Compound(copies_on_circle(planets, lining)),
            "cast iron": fused(copies_on_circle(planets, Pos(0, 0, low) * arm)) - eye,
        }
    )


def clock_wheel(module: Real, teeth: int, leaves: int, thickness: Real, spokes: int) -> Assembly:
    """A crossed-out brass wheel of cycloidal teeth on a steel arbor, with its leaf pinion."""
    pitch, arbor = module * teeth, 3 * module
    rim, hub, spoke = pitch - 8 * module, 9 * module, 3 * module
    wheel = py_gearworks.CycloidGear(teeth, height=thickness, module=module).build_part()
    opening = tube(rim, hub, thickness)
    opening -= copies_on_circle(spokes, block(rim, spoke, thickness, (rim / 2, 0, 0)))
    wheel -= opening
    collet = rod(hub - 2 * module, 2 * thickness, (0, 0, thickness))
    pinion = py_gearworks.CycloidGear(leaves, height=4 * thickness, module=module).build_part()
    pinion = Pos(0, 0, 5 * thickness) * pinion
    low, high, pivot = -6 * thickness, 13 * thickness, arbor / 2
    shaft = chamfered_rod(arbor, high - low, 0.2 * arbor, (0, 0, low))
    shaft += chamfered_rod(pivot, high - low + 4 * arbor, 0.2 * pivot, (0, 0, low - 2 * arbor))
    return Assembly({"brass": wheel + collet - shaft, "bright steel": shaft + pinion})


RECIPES = [
    Recipe(
        "gear-ring-m1-5-z60",
        "ISO 53 internal, m1.5 z60, 15 wide",
        "py_gearworks",
        ring_gear,
        {"module": 1.5, "teeth": 60, "width": 15.0, "bolts": 6, "bolt_hole": 5.5},
    ),
    Recipe(
        "planetary-set-m1-5-18-18-54",
        "planetary gear set m1.5, 18/18/54 teeth, three planets",
        "py_gearworks",
        planetary_set,
        {"module": 1.5, "sun": 18, "planet": 18, "width": 12.0, "pin": 7.0},
    ),
    Recipe(
        "clock-wheel-m1-z48",
        "crossed-out clock wheel m1 z48 with 8-leaf pinion, cycloidal",
        "py_gearworks",
        clock_wheel,
        {"module": 1.0, "teeth": 48, "leaves": 8, "thickness": 2.0, "spokes": 5},
    ),
]
