"""How long does a part take to load, to measure and to draw, and is what is shipped sound?

python benchmarks/dataset.py           every embedded part: loaded, checked, measured, pictured
python benchmarks/dataset.py bake      and drawn anew, in this process; needs the [cad] extra

Seconds are of one core (set OMP_NUM_THREADS=1) and of the processor, so that a busy machine does
not count; `worst` is the slowest part.
"""

import sys
import warnings
from collections.abc import Callable, Sequence
from time import process_time

import numpy as np
from rich.console import Console
from rich.progress import track
from rich.table import Table

from industnerf.artifacts.part import Mesh
from industnerf.geometry.portrait import portrait
from industnerf.geometry.raycast import Scene
from industnerf.parts import checks
from industnerf.parts.card.tables import checks_table
from industnerf.parts.catalogue import catalogue, load
from industnerf.parts.measure import measure, visible_share
from industnerf.parts.sheet import PICTURE_PX
from industnerf.parts.strata import shape_of

Work = tuple[str, Callable[[], object]]


def seconds(work: Callable[[], object]) -> float:
    start = process_time()
    work()
    return process_time() - start


def behind(mesh: Mesh) -> float:
    scene = Scene(mesh.vertices, mesh.faces)
    return checks.back_face_share(
        mesh.vertices, mesh.faces, lambda origins, towards: scene.cast(origins, towards).face
    )


def picture(mesh: Mesh) -> object:
    return portrait(mesh.vertices, mesh.faces, np.full((len(mesh.faces), 3), 0.5), PICTURE_PX)


def reading() -> list[tuple[str, list[Work]]]:
    """For each embedded part, what is timed of it."""
    steps = {
        "back faces": behind,
        "visible share": visible_share,
        "strata": shape_of,
        "all facts": measure,
        "portrait": picture,
    }
    works = []
    for entry in catalogue():
        mesh = load(entry)
        timed = [(name, lambda step=step, mesh=mesh: step(mesh)) for name, step in steps.items()]
        works.append((entry.id, [("load", lambda entry=entry: load(entry)), *timed]))
    return works


def drawing() -> list[tuple[str, list[Work]]]:
    """For each recipe of an embedded part, its baking."""
    warnings.simplefilter("ignore")  # the CAD libraries' own
    from industnerf.parts.bake import bake
    from industnerf.parts.families import FAMILIES

    return [
        (recipe.id, [("bake", lambda family=family, recipe=recipe: bake(family, recipe))])
        for family, recipes in FAMILIES.items()
        for recipe in recipes
    ]


def report(parts: Sequence[tuple[str, list[Work]]], console: Console) -> None:
    """A row per step: seconds of the median part, of the worst, and of all."""
    names = [part_id for part_id, _ in parts]
    spent: dict[str, list[float]] = {}
    for _, works in track(parts, "Timing", console=console):
        for step, work in works:
            spent.setdefault(step, []).append(seconds(work))
    table = Table(title=f"{len(parts)} parts, seconds")
    for head in ("step", "median", "worst", "of", "all"):
        table.add_column(head)
    for step, took in spent.items():
        worst = int(np.argmax(took))
        cells = (f"{np.median(took):.3f}", f"{took[worst]:.3f}", names[worst], f"{sum(took):.1f}")
        table.add_row(step, *cells)
    console.print(table)


def main(what: list[str]) -> None:
    console = Console(width=120)
    print(checks_table(catalogue()))
    report(reading(), console)
    if what == ["bake"]:
        report(drawing(), console)


if __name__ == "__main__":
    main(sys.argv[1:])
