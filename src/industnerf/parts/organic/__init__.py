"""The non-industrial set: does what was tuned on industrial parts carry over to other shapes?

Three families: `organic`, `thin` and `textured`.  No CAD kernel is needed to draw them.
"""

from industnerf.parts.organic import grown, patterns, pottery, sheets, shells, wires
from industnerf.parts.organic.sculpture import Sculpture, glaze

_ORGANIC = [
    Sculpture(
        "organic-sauropod",
        "long-necked animal of limbs in a smooth union, striped",
        grown.sauropod,
        {"length": 160.0, "stripes": 9},
        2.2,
        (
            glaze("green skin", 0.16, 0.36, 0.16),
            glaze("black eye", 0.03, 0.03, 0.03, 0.2),
            glaze("dark stripe", 0.07, 0.14, 0.09),
        ),
    ),
    Sculpture(
        "organic-coral",
        "branching coral, an L-system of five forks",
        grown.coral,
        {"height": 120.0, "forks": 5, "seed": 4},
        2.05,
        (glaze("red coral", 0.62, 0.16, 0.10), glaze("pale tip", 0.72, 0.55, 0.42)),
    ),
    Sculpture(
        "organic-seashell",
        "ribbed snail shell, Raup's logarithmic spiral",
        shells.seashell,
        {"height": 80.0, "whorls": 5, "ribs": 11},
        1.9,
        (glaze("sand", 0.62, 0.47, 0.30), glaze("mother of pearl", 0.70, 0.52, 0.48, 0.25)),
    ),
    Sculpture(
        "organic-supershape",
        "seven-lobed fruit, Gielis' superformula",
        shells.supershape,
        {"diameter": 90.0, "lobes": 7},
        1.4,
        (glaze("orange rind", 0.66, 0.28, 0.05), glaze("green furrow", 0.22, 0.32, 0.07)),
    ),
    Sculpture(
        "organic-pebble",
        "noisy pebble with veins",
        shells.pebble,
        {"length": 80.0, "seed": 1},
        1.4,
        (
            glaze("slate", 0.22, 0.23, 0.25, 0.8),
            glaze("quartz", 0.70, 0.69, 0.66),
            glaze("rust", 0.38, 0.24, 0.16, 0.8),
        ),
    ),
    Sculpture(
        "organic-knot",
        "(2, 3) torus knot",
        shells.knot,
        {"diameter": 100.0, "p": 2, "q": 3},
        1.7,
        (glaze("violet glaze", 0.30, 0.14, 0.44, 0.25),),
    ),
]
_THIN = [
    Sculpture(
        "thin-leaf",
        "bent and folded leaf with veins, 1.4 mm",
        sheets.leaf,
        {"length": 140.0, "thickness": 1.4, "veins": 8},
        1.8,
        (glaze("leaf green", 0.12, 0.36, 0.08), glaze("vein", 0.48, 0.56, 0.22)),
    ),
    Sculpture(
        "thin-scroll",
        "written paper, rolled up at one end, 1.2 mm",
        sheets.scroll,
        {"width": 110.0, "thickness": 1.2, "turns": 2},
        1.9,
        (glaze("paper", 0.70, 0.66, 0.54, 0.9), glaze("ink", 0.04, 0.04, 0.08)),
    ),
    Sculpture(
        "thin-umbrella",
        "open umbrella of eight panels, 1.3 mm",
        sheets.umbrella,
        {"diameter": 150.0, "ribs": 8, "thickness": 1.3},
        2.8,
        (
            glaze("red panel", 0.58, 0.06, 0.06),
            glaze("steel rib", 0.45, 0.46, 0.48, 0.3),
            glaze("bamboo", 0.55, 0.38, 0.16),
            glaze("white panel", 0.70, 0.70, 0.68),
        ),
    ),
    Sculpture(
        "thin-basket",
        "woven basket of 2.4 mm wire",
        wires.basket,
        {"diameter": 120.0, "wire": 2.4, "staves": 20, "hoops": 6},
        3.2,
        (glaze("willow", 0.50, 0.33, 0.15), glaze("dark willow", 0.22, 0.12, 0.06)),
    ),
    Sculpture(
        "thin-gyroid",
        "gyroid wall in a ball, 3 mm",
        wires.gyroid,
        {"diameter": 84.0, "cell": 42.0, "thickness": 3.0},
        2.8,
        (glaze("turquoise resin", 0.10, 0.46, 0.46, 0.3),),
    ),
]
_TEXTURED = [
    Sculpture(
        "textured-ball",
        "ball in a checker of four colours",
        patterns.ball,
        {"diameter": 80.0, "columns": 12, "rows": 7},
        1.5,
        (
            glaze("red", 0.58, 0.07, 0.06),
            glaze("white", 0.70, 0.70, 0.68),
            glaze("blue", 0.08, 0.18, 0.50),
            glaze("yellow", 0.70, 0.50, 0.06),
        ),
    ),
    Sculpture(
        "textured-egg",
        "marbled egg in six colours",
        patterns.egg,
        {"length": 80.0, "band": 9.0, "colours": 6, "seed": 2},
        1.4,
        (
            glaze("indigo", 0.06, 0.08, 0.30),
            glaze("azure", 0.12, 0.34, 0.58),
            glaze("ivory", 0.71, 0.66, 0.54),
            glaze("ochre", 0.60, 0.38, 0.10),
            glaze("brick", 0.46, 0.13, 0.08),
            glaze("umber", 0.14, 0.07, 0.05),
        ),
    ),
    Sculpture(
        "textured-vase",
        "hollow vase with bands and zigzags",
        pottery.vase,
        {"height": 150.0, "wall": 4.0, "teeth": 10},
        3.2,
        (
            glaze("clay", 0.62, 0.44, 0.28, 0.8),
            glaze("black slip", 0.05, 0.04, 0.04, 0.4),
            glaze("red slip", 0.48, 0.12, 0.06, 0.6),
            glaze("white slip", 0.71, 0.69, 0.62, 0.6),
        ),
    ),
    Sculpture(
        "textured-teapot",
        "turned teapot with dots",
        pottery.teapot,
        {"diameter": 100.0, "dots": 60},
        2.0,
        (
            glaze("white china", 0.71, 0.71, 0.69, 0.2),
            glaze("blue china", 0.06, 0.14, 0.42, 0.2),
            glaze("red dot", 0.58, 0.08, 0.07, 0.2),
        ),
    ),
    Sculpture(
        "textured-fox",
        "fox of coloured cubes",
        patterns.fox,
        {"cube": 6.0},
        6.0,
        (
            glaze("orange fur", 0.64, 0.25, 0.05),
            glaze("white fur", 0.71, 0.70, 0.66),
            glaze("black fur", 0.06, 0.05, 0.05),
        ),
    ),
]
FAMILIES: dict[str, list[Sculpture]] = {
    "organic": _ORGANIC,
    "thin": _THIN,
    "textured": _TEXTURED,
}
