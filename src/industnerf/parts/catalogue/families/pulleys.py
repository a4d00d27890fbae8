"""Belt pulleys and rope sheaves."""

import math

from build123d import Circle, Pos, Rot, Shape

from industnerf.parts.catalogue.families.drawing import (
    PRESS,
    Real,
    bar,
    half_section,
    hub_keyway,
    mirrored,
    on_circle,
    polygon,
    rod,
    rods,
    spun,
    turned,
)
from industnerf.parts.catalogue.recipe import Assembly, MeshBoolean, Recipe


def timing_pulley(teeth: int, belt: float, bore: float) -> Assembly:
    """HTD 5M pulley of ISO 13050 with two flanges and a hub with set screws.

    Tooth spaces are drawn as circular arcs without their tip rounding.
    """
    pitch, pitch_line, space_depth, space_radius = 5.0, 1.143, 2.06, 1.49
    outside = teeth * pitch / math.pi - pitch_line
    face, disc, hub, hub_length = belt + 2.5, 1.2, 0.72 * outside, 8.0
    flange = turned(
        [
            (hub / 2 - PRESS, 0),
            (outside / 2 + 2.2, -0.6),
            (outside / 2 + 2.2, disc - 0.6),
            (outside / 2 - 0.3, disc),
            (outside / 2 - 2.5, disc + PRESS),
            (hub / 2 - PRESS, disc + PRESS),
        ]
    )
    toothed = rod(outside, face)
    centers = on_circle(teeth, outside - 2 * (space_depth - space_radius))
    toothed -= rods(centers, 2 * space_radius, face)
    body = toothed + rod(hub, hub_length + face + 2.5 * disc, (0, 0, -hub_length - disc))
    screws = [
        bar(4.2, hub, axis, position)
        for axis, position in (("x", (hub / 2, 0, -5.0)), ("y", (0, hub / 2, -5.0)))
    ]
    body -= [rod(bore, 2 * face + 2 * hub_length, (0, 0, -hub_length - 2 * disc)), *screws]
    flanges = [Pos(0, 0, -disc) * flange, Pos(0, 0, face + disc) * Rot(180, 0, 0) * flange]
    return Assembly({"aluminum": body, "zinc": MeshBoolean(join=flanges, cut=[])})


def spa_groove(outside: Real, datum: Real) -> Shape:
    """What a lathe takes out for a belt SPA, ISO 4183, between two broken edges; about z = 0.

    At the diameter `datum` it is 11 mm wide; up to 118 mm its flanks are at 34 degrees.
    """
    width, depth, edge, tan = 11.0, 11.0, 0.5, math.tan(math.radians(17))
    bottom, rim = datum / 2 - depth, outside / 2
    floor, mouth = width / 2 - depth * tan, (width + (outside - datum) * tan) / 2
    upper = [(bottom, floor), (rim - edge, mouth), (rim, mouth + edge), (outside, mouth + edge)]
    return turned(mirrored(upper))


def vbelt_pulley(datum: float, grooves: int, bore: float, key: float) -> Shape:
    """Cast pulley for narrow V-belts SPA of ISO 4183, with a web and a keyed hub."""
    above, spacing, margin, wall, draft = 2.75, 15.0, 10.0, 17.0, 1.5
    width, outside = (grooves - 1) * spacing + 2 * margin, datum + 2 * above
    rim, web, hub, hub_length = datum / 2 - wall, 0.3 * width, 2.1 * bore, 1.2 * width
    low, high = (width - web) / 2, (width + web) / 2
    body = turned(
        [
            (0, 0),
            (hub / 2, 0),
            (hub / 2 + draft, low),
            (rim - draft, low),
            (rim, 0),
            (outside / 2, 0),
            (outside / 2, width),
            (rim, width),
            (rim - draft, high),
            (hub / 2 + draft, high),
            (hub / 2, hub_length),
            (0, hub_length),
        ]
    )
    groove = spa_groove(outside, datum)
    body -= [Pos(0, 0, margin + i * spacing) * groove for i in range(grooves)]
    body -= rods(on_circle(5, rim + hub / 2), 0.55 * (rim - hub / 2), width)
    return body - rod(bore, hub_length) - hub_keyway(bore, key, 0.42 * key, hub_length)


def rope_sheave(diameter: float, rope: float, bore: float, holes: int) -> Assembly:
    """Cast sheave with a bronze bush, centered on the origin; `diameter` is outside.

    Its groove, after DIN 15061, has a radius of 0.53 `rope` and opens by 45 degrees.
    """
    groove, depth, flank = 0.53 * rope, 1.7 * rope, math.radians(22.5)
    center = diameter / 2 - depth + groove  # radius at which the rope's axis runs
    foot = (center - groove * math.sin(flank), groove * math.cos(flank))
    top = (diameter, foot[1] + (diameter - foot[0]) * math.tan(flank))
    mouth = foot[1] + (diameter / 2 - foot[0]) * math.tan(flank)
    face, web, hub, hub_length = 2 * mouth + 0.8 * rope, 1.1 * rope, 2 * bore, 4 * rope
    shell, bush, draft = diameter / 2 - depth - 0.9 * rope, 1.4 * bore, 0.2 * rope
    body = polygon(
        mirrored(
            [
                (bush / 2 - PRESS, hub_length / 2),
                (hub / 2, hub_length / 2),
                (hub / 2 + draft, web / 2),
                (shell - draft, web / 2),
                (shell, face / 2 - draft),
                (diameter / 2 - draft, face / 2),
                (diameter / 2, face / 2 - draft),
            ]
        )
    )
    body -= Pos(center, 0) * Circle(groove)
    body -= polygon(mirrored([foot, top]))
    hole = 0.6 * (shell - hub / 2)
    drilled = rods(on_circle(holes, shell + hub / 2), hole, face, -face / 2)
    return Assembly(
        {
            "yellow paint": spun(body) - drilled,
            "bronze": spun(half_section(bore, bush, -0.52 * hub_length, 0.52 * hub_length, 1)),
        }
    )


RECIPES = [
    Recipe(
        "pulley-htd-5m-30",
        "ISO 13050 HTD 30-5M-15-like",
        "build123d",
        timing_pulley,
        {"teeth": 30, "belt": 15.0, "bore": 10.0},
    ),
    Recipe(
        "pulley-vbelt-iso4183-spa112-2",
        "ISO 4183 SPA 112-2-like",
        "build123d",
        vbelt_pulley,
        {"datum": 112.0, "grooves": 2, "bore": 24.0, "key": 8.0},
        finish="cast iron",
    ),
    Recipe(
        "rope-sheave-d160",
        "DIN 15061-like rope sheave D160 for 10 mm rope",
        "build123d",
        rope_sheave,
        {"diameter": 160.0, "rope": 10.0, "bore": 25.0, "holes": 6},
    ),
]
