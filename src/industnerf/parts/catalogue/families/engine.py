"""Parts of piston engines."""

from build123d import Pos, Shape, Sphere, extrude

from industnerf.parts.catalogue.families import cylinder_block, engine_fittings
from industnerf.parts.catalogue.families.drawing import (
    bar,
    block,
    fused,
    polygon,
    rod,
    rounded_block,
    turned,
)
from industnerf.parts.catalogue.recipe import Assembly, Recipe


def piston(bore: float, height: float, compression_height: float, pin: float) -> Shape:
    """Petrol-engine piston, crown up, pin along x; the pin's axis lies at z = 0.

    Three ring grooves, a dished crown, a slipper skirt hollowed to the pin bosses.
    """
    clearance, crown, wall = 0.1, 0.075 * bore, 0.05 * bore
    top, bottom = compression_height, compression_height - height
    radius = bore / 2 - clearance
    groove = radius - 0.042 * bore
    grooves = [(7.0, 1.2), (11.8, 1.5), (16.8, 2.5)]  # from the crown, and width
    outline = [(0, top), (radius - 0.5, top), (radius, top - 0.5)]
    for start, width in grooves:
        outline += [(radius, top - start), (groove, top - start)]
        outline += [(groove, top - start - width), (radius, top - start - width)]
    outline += [(radius, bottom), (0, bottom)]
    body = turned(outline)

    hollow = bore / 2 - wall
    ring_land = hollow - 0.06 * bore
    inside = turned(
        [
            (0, bottom),
            (hollow, bottom),
            (hollow, 0.2 * pin),
            (ring_land, top - 20.0),
            (0.8 * ring_land, top - crown),
            (0, top - crown),
        ]
    )
    boss, boss_gap = 1.65 * pin, 0.3 * bore
    bosses = bar(boss, bore, "x") + block(bore, 0.9 * boss, top - 4, (0, 0, 0))
    bosses -= block(boss_gap, bore, 2 * height, (0, 0, bottom))
    body = body - inside + (bosses & rod(2 * hollow + 1, height - 3, (0, 0, bottom)))
    # the skirt is cut back beside the bosses
    for side in (1, -1):
        body -= block(0.22 * bore, 0.62 * bore, 0.5 * height, (side * bore / 2, 0, bottom))
    body -= bar(pin, 2 * bore, "x")
    clip = 1.08 * pin
    body -= [bar(clip, 1.4, "x", (side * 0.36 * bore, 0, 0)) for side in (1, -1)]
    dish_radius = 1.1 * bore
    return body - Pos(0, 0, top + dish_radius - 0.05 * bore) * Sphere(dish_radius)


def connecting_rod(centers: float, big_end: float, small_end: float) -> Assembly:
    """I-section rod with its cap bolted on; small end at the origin, big end along +x.

    The joint of the cap shows as a fine groove across the bolt bosses.
    """
    big_outer, big_width = 1.26 * big_end, 0.48 * big_end
    small_outer, small_width = 1.5 * small_end, 1.15 * small_end
    flange, web, rim = 0.7 * small_end, 0.22 * small_end, 0.17 * small_end
    boss_across, boss_along, bolt, head = 0.3 * big_end, 0.62 * big_end, 8.0, 13.0
    boss_y = big_end / 2 + 0.4 * boss_across
    narrow, wide = 0.36 * small_outer, 0.3 * big_outer  # half-widths of the shank

    def at_big(shape: Shape) -> Shape:
        return Pos(centers, 0, 0) * shape

    body = extrude(
        polygon([(0, -narrow), (centers, -wide), (centers, wide), (0, narrow)]),
        flange / 2,
        both=True,
    )
    start, stop = 0.5 * small_outer + rim, centers - 0.5 * big_outer - rim
    pocket = polygon(
        [
            (start, rim - narrow),
            (stop, 1.3 * rim - wide),
            (stop, wide - 1.3 * rim),
            (start, narrow - rim),
        ]
    )
    body -= [Pos(0, 0, z) * extrude(pocket, flange) for z in (web / 2, -web / 2 - flange)]
    body += rod(small_outer, small_width, (0, 0, -small_width / 2))
    body += at_big(rod(big_outer, big_width, (0, 0, -big_width / 2)))
    for side in (1, -1):
        boss = rounded_block(
            boss_along, boss_across, big_width, 2.0, (0, side * boss_y, -big_width / 2)
        )
        body += at_big(boss)
    body -= rod(small_end, 2 * small_width, (0, 0, -small_width))
    body -= at_big(rod(big_end, 2 * big_width, (0, 0, -big_width)))
    heads = [
        at_big(
            bar(head, 0.16 * big_end, "x", (0.36 * big_end, s * boss_y, 0))
            - bar(0.6 * bolt, 0.2 * big_end, "x", (0.44 * big_end, s * boss_y, 0))
        )
        for s in (1, -1)
    ]
    joint = block(0.5, 2 * big_outer, 2 * big_width, (centers, 0, -big_width))
    joint -= at_big(
        block(1, 2 * (boss_y + boss_across / 2 - 0.6), big_width - 1.2, (0, 0, 0.6 - big_width / 2))
    )
    return Assembly({"steel": body - joint, "black oxide": fused(heads)})


RECIPES = [
    Recipe(
        "connecting-rod-144",
        "connecting rod, 144 between centers",
        "build123d",
        connecting_rod,
        {"centers": 144.0, "big_end": 50.0, "small_end": 22.0},
    ),
    Recipe(
        "piston-d84",
        "petrol-engine piston D84",
        "build123d",
        piston,
        {"bore": 84.0, "height": 56.0, "compression_height": 31.0, "pin": 21.0},
        finish="aluminum",
    ),
    *cylinder_block.RECIPES,
    *engine_fittings.RECIPES,
]
