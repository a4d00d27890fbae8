"""Wheels that carry or are turned by hand; the others are in `drives` and `pulleys`."""

from build123d import Pos, Rot, Torus

from industnerf.parts.catalogue.families import drives, pulleys
from industnerf.parts.catalogue.families.drawing import (
    block,
    copies_on_circle,
    half_section,
    hub_keyway,
    mirrored,
    rod,
    spun,
    turned,
)
from industnerf.parts.catalogue.recipe import Assembly, MeshBoolean, Recipe


def handwheel(diameter: float, bore: float, key: float, spokes: int) -> Assembly:
    """Dished hand wheel with a revolving handle, after DIN 950 and DIN 39.

    The rim lies in the plane z = 0, the hub below.  United as meshes: OpenCASCADE loses the rim.
    """
    rim = 0.1 * diameter  # thickness
    rim_circle = diameter - rim
    hub, hub_length, dish = 0.24 * diameter, 0.19 * diameter, 0.16 * diameter
    handle, handle_length = 0.15 * diameter, 0.44 * diameter

    spoke_length = rim_circle / 2
    spoke = turned(
        [(0, 0), (0.042 * diameter, 0), (0.032 * diameter, spoke_length), (0, spoke_length)]
    )
    # from the middle of the hub outwards, climbing to the rim
    spoke = Pos(0, 0, -0.5 * dish) * Rot(0, 81, 0) * spoke
    grip = turned(
        [
            (0, -0.2 * rim),
            (0.3 * handle, -0.2 * rim),
            (0.3 * handle, 0.6 * rim),
            (0.34 * handle, 0.65 * rim),
            (0.45 * handle, 0.4 * handle_length),
            (0.5 * handle, 0.65 * handle_length),
            (0.42 * handle, 0.92 * handle_length),
            (0.25 * handle, handle_length),
            (0, handle_length),
        ]
    )
    wheel = MeshBoolean(
        join=[
            Torus(rim_circle / 2, rim / 2),
            rod(hub, hub_length, (0, 0, -dish)),
            *copies_on_circle(spokes, spoke),
        ],
        cut=[
            rod(bore, 2 * diameter, (0, 0, -diameter)),
            hub_keyway(bore, key, 0.45 * key, 2 * diameter, -diameter),
        ],
    )
    grip = Rot(0, 0, 180 / spokes) * Pos(rim_circle / 2, 0, 0) * grip
    return Assembly({"cast iron": wheel, "black plastic": grip})


def caster_wheel(diameter: float, width: float, hub_length: float, bore: float) -> Assembly:
    """Ribbed plastic caster wheel with a rubber tread and a steel bush, after ISO 22881."""
    rim, crown, hub, web, ribs = 0.78 * diameter, 0.96 * diameter, 2.4 * bore, 0.2 * width, 6
    bed = 0.45 * diameter  # radius of the rim below the tread
    profile = [
        (0.6 * bore, hub_length / 2),
        (hub / 2, hub_length / 2),
        (0.56 * hub, web / 2),
        (0.47 * rim, web / 2),
        (0.49 * rim, 0.42 * width),
        (0.49 * rim, 0.5 * width),
        (0.98 * bed, 0.5 * width),
        (bed, 0.4 * width),
    ]
    tread = [
        (0.96 * bed, 0.3 * width),
        (1.01 * bed, 0.47 * width),
        (crown / 2, 0.4 * width),
        (0.497 * diameter, 0.2 * width),
        (diameter / 2, 0.06 * width),
    ]
    inside, outside = 0.45 * hub, 0.47 * rim
    rib = block(
        outside - inside, 0.1 * width, 0.66 * width, ((inside + outside) / 2, 0, -0.33 * width)
    )
    bush = spun(half_section(bore, 1.4 * bore, -0.52 * hub_length, 0.52 * hub_length))
    return Assembly(
        {
            "white plastic": turned(mirrored(profile)) + copies_on_circle(ribs, rib),
            "rubber": turned(mirrored(tread)),
            "steel": bush,
        }
    )


RECIPES = [
    Recipe(
        "caster-wheel-d100",
        "ISO 22881 caster wheel D100-like",
        "build123d",
        caster_wheel,
        {"diameter": 100.0, "width": 32.0, "hub_length": 44.0, "bore": 12.0},
    ),
    Recipe(
        "handwheel-din950-d160",
        "DIN 950 D160-like",
        "build123d",
        handwheel,
        {"diameter": 160.0, "bore": 16.0, "key": 5.0, "spokes": 5},
    ),
    *drives.RECIPES,
    *pulleys.RECIPES,
]
