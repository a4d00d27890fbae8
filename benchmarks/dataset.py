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
from industnerf.geometry.raycast import RaycastingScene
from industnerf.geometry.thumbnail import render_thumbnail
from industnerf.parts.catalogue.data_card.tables import checks_table
from industnerf.parts.catalogue.entries import load_catalogue_mesh, read_catalogue
from industnerf.parts.contact_sheet import TILE_PX
from industnerf.parts.measure import measure, visible_share
from industnerf.parts.strata import measure_shape
from industnerf.parts.validation import checks

Task = tuple[str, Callable[[], object]]


def seconds(task: Callable[[], object]) -> float:
    start = process_time()
    task()
    return process_time() - start


def back_faces(mesh: Mesh) -> float:
    scene = RaycastingScene(mesh.vertices, mesh.faces)
    return checks.back_face_share(
        mesh.vertices, mesh.faces, lambda origins, towards: scene.cast(origins, towards).face
    )


def draw_thumbnail(mesh: Mesh) -> object:
    return render_thumbnail(mesh.vertices, mesh.faces, np.full((len(mesh.faces), 3), 0.5), TILE_PX)


def read_tasks() -> list[tuple[str, list[Task]]]:
    """For each embedded part, what is timed of it."""
    steps = {
        "back faces": back_faces,
        "visible share": visible_share,
        "strata": measure_shape,
        "all facts": measure,
        "portrait": draw_thumbnail,
    }
    tasks = []
    for entry in read_catalogue():
        mesh = load_catalogue_mesh(entry)
        timed = [(name, lambda step=step, mesh=mesh: step(mesh)) for name, step in steps.items()]
        tasks.append((entry.id, [("load", lambda entry=entry: load_catalogue_mesh(entry)), *timed]))
    return tasks


def bake_tasks() -> list[tuple[str, list[Task]]]:
    """For each recipe of an embedded part, its baking."""
    warnings.simplefilter("ignore")  # the CAD libraries' own
    from industnerf.parts.catalogue.families import FAMILIES
    from industnerf.parts.catalogue.part_builder import build_part

    return [
        (recipe.id, [("bake", lambda family=family, recipe=recipe: build_part(family, recipe))])
        for family, recipes in FAMILIES.items()
        for recipe in recipes
    ]


def print_report(parts: Sequence[tuple[str, list[Task]]], console: Console) -> None:
    """A row per step: seconds of the median part, of the worst, and of all."""
    names = [part_id for part_id, _ in parts]
    seconds_by_step: dict[str, list[float]] = {}
    for _, tasks in track(parts, "Timing", console=console):
        for step, task in tasks:
            seconds_by_step.setdefault(step, []).append(seconds(task))
    table = Table(title=f"{len(parts)} parts, seconds")
    for head in ("step", "median", "worst", "of", "all"):
        table.add_column(head)
    for step, step_seconds in seconds_by_step.items():
        worst = int(np.argmax(step_seconds))
        cells = (
            f"{np.median(step_seconds):.3f}",
            f"{step_seconds[worst]:.3f}",
            names[worst],
            f"{sum(step_seconds):.1f}",
        )
        table.add_row(step, *cells)
    console.print(table)


def main(arguments: list[str]) -> None:
    console = Console(width=120)
    print(checks_table(read_catalogue()))
    print_report(read_tasks(), console)
    if arguments == ["bake"]:
        print_report(bake_tasks(), console)


if __name__ == "__main__":
    main(sys.argv[1:])
