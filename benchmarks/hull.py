"""What does a visual hull cost?

python benchmarks/hull.py [part ...]     ids of embedded parts; without any, a choice of ten

Seconds are those of the processor (set OMP_NUM_THREADS=1), so that a busy machine counts little.
Every row is a process of its own, which reads the masks and makes the hull; `peak MB` is all of
its memory.  `look-ups` are values read from the silhouettes' distance images.
"""

import multiprocessing
import resource
import sys
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from time import process_time

import numpy as np
from rich.console import Console
from rich.table import Table
from solids import solids

from industnerf.artifacts.part import Mesh
from industnerf.capture.rigs import bounding_ball, cameras_around
from industnerf.config import load_params
from industnerf.geometry.cameras import Cameras, back_projection, pixel_centers
from industnerf.geometry.raycast import RaycastingScene
from industnerf.methods.hull import octree, surface
from industnerf.methods.hull.silhouettes import distance_images
from industnerf.schema import HullSettings, ViewsParams

HEADS = ["px", "cell px", "images s", "octree s", "points s", "all s", "peak MB"]
HEADS += ["cells M", "look-ups M", "points"]
FORMS = ["d", "g", ".2f", ".2f", ".2f", ".2f", ".0f", ".2f", ".1f", "d"]
RESOLUTIONS, CELLS_PX = (128, 256, 512, 1024), (0.5, 1.0, 2.0, 4.0)


def masks_of(mesh: Mesh, settings: ViewsParams) -> tuple[np.ndarray, Cameras]:
    """The training views' masks: pixels whose center shows the part."""
    cameras, held_out = cameras_around(*bounding_ball(mesh.vertices), settings)
    cameras, scene = cameras[~held_out], RaycastingScene(mesh.vertices, mesh.faces)
    uv1 = np.insert(pixel_centers(cameras.width, cameras.height), 2, 1, axis=1)
    masks = [
        np.isfinite(scene.distance(c2w[None, :3, 3], uv1 @ back_projection(K, c2w).T))
        for K, c2w in zip(cameras.K, cameras.c2w, strict=True)
    ]
    return np.stack(masks).reshape(-1, cameras.height, cameras.width), cameras


def measure(masks: np.ndarray, cameras: Cameras, settings: HullSettings) -> list[str]:
    """One row, but for the name."""
    num_lookups = 0

    def counted(function: Callable[..., np.ndarray]) -> Callable[..., np.ndarray]:
        def count(image: np.ndarray, u: np.ndarray, v: np.ndarray) -> np.ndarray:
            nonlocal num_lookups
            num_lookups += len(u)
            return function(image, u, v)

        return count

    octree.bilinear = counted(octree.bilinear)
    surface.bilinear = counted(surface.bilinear)
    times = [process_time()]
    silhouettes = distance_images(masks, cameras, 0.0)
    times.append(process_time())
    nodes = octree.refine(silhouettes, settings.cell_px, surface.SEGMENT_LENGTH)
    times.append(process_time())
    points = surface.sample_hull_surface(
        silhouettes, nodes, settings.points, np.random.default_rng(0)
    )
    times.append(process_time())
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024  # kB on Linux
    row = [cameras.width, settings.cell_px, *np.diff(times), times[-1] - times[0], peak]
    row += [nodes.num_open / 1e6, num_lookups / 1e6, len(points)]
    return [f"{value:{form}}" for value, form in zip(row, FORMS, strict=True)]


def run_in_subprocess(masks: np.ndarray, cameras: Cameras, settings: HullSettings) -> list[str]:
    """`measure` in a new process."""
    with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
        return pool.submit(measure, masks, cameras, settings).result()


def new_table(title: str) -> Table:
    table = Table(title=title)
    table.add_column("part")
    for head in HEADS:
        table.add_column(head, justify="right")
    return table


def main(names: list[str]) -> None:
    params, console = load_params(), Console(width=150)
    views, hull = params.views, params.method.hull
    parts = list(solids(names))
    by_part = new_table(f"{views.count} views")
    for name, mesh in parts:
        by_part.add_row(name, *run_in_subprocess(*masks_of(mesh, views), hull))
    console.print(by_part)
    name, mesh = parts[-1]
    by_size = new_table("against the resolution, then against the size of the cells")
    for resolution in RESOLUTIONS:
        varied_settings = replace(views, resolution=resolution)
        by_size.add_row(name, *run_in_subprocess(*masks_of(mesh, varied_settings), hull))
    for cell_px in CELLS_PX:
        varied_settings = replace(hull, cell_px=cell_px)
        by_size.add_row(name, *run_in_subprocess(*masks_of(mesh, views), varied_settings))
    console.print(by_size)


if __name__ == "__main__":
    main(sys.argv[1:])
