"""The non-industrial set: does what was tuned on industrial parts carry over to other shapes?

Three families: `organic`, `thin` and `textured`.  No CAD kernel is needed to draw them.
"""

from industnerf.parts.catalogue.organic import branching, patterns, pottery, sheets, shells, wires
from industnerf.parts.catalogue.organic.procedural_recipe import ProceduralRecipe, paint_appearance

_ORGANIC = [
    ProceduralRecipe(
        "organic-sauropod",
        "long-necked animal of limbs in a smooth union, striped",
        branching.sauropod,
        {"length": 160.0, "stripes": 9},
        2.2,
        (
            paint_appearance("green skin", 0.16, 0.36, 0.16),
            paint_appearance("black eye", 0.03, 0.03, 0.03, 0.2),
            paint_appearance("dark stripe", 0.07, 0.14, 0.09),
        ),
    ),
    ProceduralRecipe(
        "organic-coral",
        "branching coral, an L-system of five forks",
        branching.coral,
        {"height": 120.0, "forks": 5, "seed": 4},
        2.05,
        (
            paint_appearance("red coral", 0.62, 0.16, 0.10),
            paint_appearance("pale tip", 0.72, 0.55, 0.42),
        ),
    ),
    ProceduralRecipe(
        "organic-seashell",
        "ribbed snail shell, Raup's logarithmic spiral",
        shells.seashell,
        {"height": 80.0, "whorls": 5, "ribs": 11},
        1.9,
        (
            paint_appearance("sand", 0.62, 0.47, 0.30),
            paint_appearance("mother of pearl", 0.70, 0.52, 0.48, 0.25),
        ),
    ),
    ProceduralRecipe(
        "organic-supershape",
        "seven-lobed fruit, Gielis' superformula",
        shells.supershape,
        {"diameter": 90.0, "lobes": 7},
        1.4,
        (
            paint_appearance("orange rind", 0.66, 0.28, 0.05),
            paint_appearance("green furrow", 0.22, 0.32, 0.07),
        ),
    ),
    ProceduralRecipe(
        "organic-pebble",
        "noisy pebble with veins",
        shells.pebble,
        {"length": 80.0, "seed": 1},
        1.4,
        (
            paint_appearance("slate", 0.22, 0.23, 0.25, 0.8),
            paint_appearance("quartz", 0.70, 0.69, 0.66),
            paint_appearance("rust", 0.38, 0.24, 0.16, 0.8),
        ),
    ),
    ProceduralRecipe(
        "organic-knot",
        "(2, 3) torus knot",
        shells.knot,
        {"diameter": 100.0, "p": 2, "q": 3},
        1.7,
        (paint_appearance("violet glaze", 0.30, 0.14, 0.44, 0.25),),
    ),
]
_THIN = [
    ProceduralRecipe(
        "thin-leaf",
        "bent and folded leaf with veins, 1.4 mm",
        sheets.leaf,
        {"length": 140.0, "thickness": 1.4, "veins": 8},
        1.8,
        (
            paint_appearance("leaf green", 0.12, 0.36, 0.08),
            paint_appearance("vein", 0.48, 0.56, 0.22),
        ),
    ),
    ProceduralRecipe(
        "thin-scroll",
        "written paper, rolled up at one end, 1.2 mm",
        sheets.scroll,
        {"width": 110.0, "thickness": 1.2, "turns": 2},
        1.9,
        (
            paint_appearance("paper", 0.70, 0.66, 0.54, 0.9),
            paint_appearance("ink", 0.04, 0.04, 0.08),
        ),
    ),
    ProceduralRecipe(
        "thin-umbrella",
        "open umbrella of eight panels, 1.3 mm",
        sheets.umbrella,
        {"diameter": 150.0, "ribs": 8, "thickness": 1.3},
        2.8,
        (
            paint_appearance("red panel", 0.58, 0.06, 0.06),
            paint_appearance("steel rib", 0.45, 0.46, 0.48, 0.3),
            paint_appearance("bamboo", 0.55, 0.38, 0.16),
            paint_appearance("white panel", 0.70, 0.70, 0.68),
        ),
    ),
    ProceduralRecipe(
        "thin-basket",
        "woven basket of 2.4 mm wire",
        wires.basket,
        {"diameter": 120.0, "wire": 2.4, "staves": 20, "hoops": 6},
        3.2,
        (
            paint_appearance("willow", 0.50, 0.33, 0.15),
            paint_appearance("dark willow", 0.22, 0.12, 0.06),
        ),
    ),
    ProceduralRecipe(
        "thin-gyroid",
        "gyroid wall in a ball, 3 mm",
        wires.gyroid,
        {"diameter": 84.0, "cell": 42.0, "thickness": 3.0},
        2.8,
        (paint_appearance("turquoise resin", 0.10, 0.46, 0.46, 0.3),),
    ),
]
_TEXTURED = [
    ProceduralRecipe(
        "textured-ball",
        "ball in a checker of four colors",
        patterns.ball,
        {"diameter": 80.0, "columns": 12, "rows": 7},
        1.5,
        (
            paint_appearance("red", 0.58, 0.07, 0.06),
            paint_appearance("white", 0.70, 0.70, 0.68),
            paint_appearance("blue", 0.08, 0.18, 0.50),
            paint_appearance("yellow", 0.70, 0.50, 0.06),
        ),
    ),
    ProceduralRecipe(
        "textured-egg",
        "marbled egg in six colors",
        patterns.egg,
        {"length": 80.0, "band": 9.0, "colors": 6, "seed": 2},
        1.4,
        (
            paint_appearance("indigo", 0.06, 0.08, 0.30),
            paint_appearance("azure", 0.12, 0.34, 0.58),
            paint_appearance("ivory", 0.71, 0.66, 0.54),
            paint_appearance("ochre", 0.60, 0.38, 0.10),
            paint_appearance("brick", 0.46, 0.13, 0.08),
            paint_appearance("umber", 0.14, 0.07, 0.05),
        ),
    ),
    ProceduralRecipe(
        "textured-vase",
        "hollow vase with bands and zigzags",
        pottery.vase,
        {"height": 150.0, "wall": 4.0, "teeth": 10},
        3.2,
        (
            paint_appearance("clay", 0.62, 0.44, 0.28, 0.8),
            paint_appearance("black slip", 0.05, 0.04, 0.04, 0.4),
            paint_appearance("red slip", 0.48, 0.12, 0.06, 0.6),
            paint_appearance("white slip", 0.71, 0.69, 0.62, 0.6),
        ),
    ),
    ProceduralRecipe(
        "textured-teapot",
        "turned teapot with dots",
        pottery.teapot,
        {"diameter": 100.0, "dots": 60},
        2.0,
        (
            paint_appearance("white china", 0.71, 0.71, 0.69, 0.2),
            paint_appearance("blue china", 0.06, 0.14, 0.42, 0.2),
            paint_appearance("red dot", 0.58, 0.08, 0.07, 0.2),
        ),
    ),
    ProceduralRecipe(
        "textured-fox",
        "fox of colored cubes",
        patterns.fox,
        {"cube": 6.0},
        6.0,
        (
            paint_appearance("orange fur", 0.64, 0.25, 0.05),
            paint_appearance("white fur", 0.71, 0.70, 0.66),
            paint_appearance("black fur", 0.06, 0.05, 0.05),
        ),
    ),
]
FAMILIES: dict[str, list[ProceduralRecipe]] = {
    "organic": _ORGANIC,
    "thin": _THIN,
    "textured": _TEXTURED,
}
