"""Impellers, propellers and other bladed wheels."""

import math

from build123d import Line, Spline, extrude, loft, make_face

from industnerf.parts.catalogue.families import brakes, fans, turbines
from industnerf.parts.catalogue.families.blades import blade_section
from industnerf.parts.catalogue.families.drawing import copies_on_circle, hub_keyway, rod, turned
from industnerf.parts.catalogue.recipe import MeshBoolean, Recipe


def propeller(diameter: float, blades: int, pitch: float, hub: float, bore: float) -> MeshBoolean:
    """Fixed-pitch screw propeller about z; the pitch is the same at all radii.

    Chords and thicknesses are of the Wageningen B kind, without its skew and rake.
    """
    stations = [  # radius, chord, thickness, camber: shares of the diameter, then of the chord
        (0.06, 0.20, 0.20, 0.02),
        (0.15, 0.27, 0.13, 0.03),
        (0.25, 0.33, 0.08, 0.035),
        (0.35, 0.35, 0.055, 0.035),
        (0.43, 0.30, 0.045, 0.03),
        (0.48, 0.19, 0.045, 0.02),
        (0.50, 0.09, 0.06, 0.0),
    ]
    sections = [
        blade_section(
            r * diameter,
            math.degrees(math.atan(pitch / (2 * math.pi * r * diameter))),
            chord * diameter,
            thickness,
            camber,
        )
        for r, chord, thickness, camber in stations
    ]
    half_hub = 0.5 * hub
    body = turned(
        [
            (0, -1.2 * half_hub),
            (0.8 * half_hub, -1.2 * half_hub),
            (half_hub, 0.9 * half_hub),
            (0, 0.9 * half_hub),
        ]
    )
    return MeshBoolean(
        join=[body, *copies_on_circle(blades, loft(sections))],
        cut=[
            rod(bore, 4 * hub, (0, 0, -2 * hub)),
            hub_keyway(bore, 0.3 * bore, 0.15 * bore, 4 * hub, -2 * hub),
        ],
    )


def pump_impeller(diameter: float, bore: float, key: float, vanes: int) -> MeshBoolean:
    """Semi-open radial impeller: backward-curved vanes of constant angle on a curved back plate.

    The vane's line is a logarithmic spiral, r = r1 exp(theta tan(beta)), beta = 27 degrees.
    """
    outer, eye, hub = diameter / 2, 0.25 * diameter, 0.16 * diameter
    vane, tan_beta = 0.022 * diameter, math.tan(math.radians(27))
    plate, hub_height = 0.035 * diameter, 0.27 * diameter
    inlet, outlet = 0.25 * diameter, 0.12 * diameter  # heights of the vanes
    back = turned(
        [
            (0, 0),
            (outer, 0),
            (outer, plate),
            (0.7 * outer, 1.5 * plate),
            (0.48 * outer, 2.7 * plate),
            (1.1 * hub, 0.8 * hub_height),
            (hub, hub_height),
            (0, hub_height),
        ]
    )
    radii = [0.9 * hub + (1.02 * outer - 0.9 * hub) * i / 11 for i in range(12)]

    def side(offset: float) -> Spline:
        angles = [math.log(r / radii[0]) / tan_beta for r in radii]
        # the spiral leaves the circle by beta, so its normal leaves the radius by as much
        normal = [a - math.atan(tan_beta) for a in angles]
        return Spline(
            *[
                (r * math.cos(a) + offset * math.cos(n), r * math.sin(a) + offset * math.sin(n))
                for r, a, n in zip(radii, angles, normal, strict=True)
            ]
        )

    left, right = side(vane / 2), side(-vane / 2)
    strip = make_face([left, right, Line(left @ 0, right @ 0), Line(left @ 1, right @ 1)])
    envelope = turned(
        [
            (0, 0),
            (outer, 0),
            (outer, outlet),
            (0.72 * outer, 1.25 * outlet),
            (eye, inlet),
            (0, 1.08 * inlet),
        ]
    )
    blade = extrude(strip, hub_height) & envelope
    return MeshBoolean(
        join=[back, *copies_on_circle(vanes, blade)],
        cut=[
            rod(bore, 2 * diameter, (0, 0, -diameter)),
            hub_keyway(bore, key, 0.45 * key, 2 * diameter, -diameter),
        ],
    )


RECIPES = [
    Recipe(
        "impeller-d140",
        "semi-open pump impeller D140, 6 vanes",
        "build123d",
        pump_impeller,
        {"diameter": 140.0, "bore": 20.0, "key": 6.0, "vanes": 6},
        finish="bronze",
    ),
    Recipe(
        "propeller-4-blade-d200",
        "4-blade propeller D200 P160",
        "build123d",
        propeller,
        {"diameter": 200.0, "blades": 4, "pitch": 160.0, "hub": 40.0, "bore": 16.0},
        finish="brass",
    ),
    *fans.RECIPES,
    *turbines.RECIPES,
    *brakes.RECIPES,
]
