"""How fast are views rendered, against bare ray casting of as many primary rays?

python benchmarks/render.py [photorealistic] [part ...]     ids of embedded parts, or a choice of 10

Both are timed in turn, view by view, on one core (set OMP_NUM_THREADS=1), so that a busy machine
slows both.  Shares are of rendering; PNG files are written, and timed, apart.  `part s` is all of
it: set-up of cameras, normals and ray tracer, rendering of the views, writing of the files.
"""

import cProfile
import pstats
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from time import perf_counter

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene
from rich.console import Console
from rich.table import Table
from solids import solids

from industnerf.artifacts.part import Mesh
from industnerf.artifacts.png import MAX_DEPTH_VALUE
from industnerf.artifacts.views import RgbdImage, Views, save_views
from industnerf.capture.image_formation import pixel_center_rays, render_image
from industnerf.capture.materials import Materials
from industnerf.capture.ray_hits import Surface
from industnerf.capture.render import view_shading, visible_share
from industnerf.capture.rigs import bounding_ball, cameras_around
from industnerf.capture.rng import random_streams
from industnerf.config import load_params
from industnerf.geometry.cameras import Cameras, back_projection
from industnerf.parts.catalogue.appearances import APPEARANCES
from industnerf.schema import ViewsParams

# Each share: the functions that it counts, less those in them that another share counts.
SHARES = {
    "bounds": (("project", "candidate_pixels"), ()),
    "rays": (("pixel_center_rays",), ()),
    "casting": (("cast_from",), ()),
    "shading": (("trace_rays",), ("cast_from",)),
    "edges": (("edge_mask", "pixel_means"), ("radiance_at",)),
    "8 bits": (("composite", "simulate_sensor"), ()),
}
HEADS = ["faces", "ready ms", "views/s", "bare views/s", "ratio", "PNG ms/view", "PNG MB", "part s"]
HEADS += [f"{name} %" for name in SHARES]
FORMS = ["d", ".0f", ".1f", ".1f", ".2f", ".1f", ".1f", ".1f"] + [".0f"] * len(SHARES)


def bare_ray_casting(mesh: Mesh, cameras: Cameras) -> Iterator[float]:
    """Seconds that embree takes for all primary rays of each camera, and nothing else.

    As `embreex` calls it: with the widest vectors of the processor.
    """
    scene = EmbreeScene(robust=True)
    low, size = mesh.vertices.min(axis=0), np.ptp(mesh.vertices, axis=0).max()
    TriangleMesh(scene, ((mesh.vertices - low) / size).astype(np.float32), mesh.faces)
    for K, c2w in zip(cameras.K, cameras.c2w, strict=True):
        rays = pixel_center_rays(back_projection(K, c2w).astype(np.float32), cameras.width)
        center = ((c2w[:3, 3] - low) / size).astype(np.float32)
        starts = np.repeat(center[None], len(rays), axis=0)
        start = perf_counter()
        scene.run(starts, rays, query="INTERSECT", output=True)
        yield perf_counter() - start


def measure(mesh: Mesh, settings: ViewsParams) -> list[str]:
    """One row: views a second rendered and bare, their ratio, PNG cost, and the shares."""
    start = perf_counter()
    center, radius_mm = bounding_ball(mesh.vertices)
    cameras, held_out = cameras_around(center, radius_mm, settings)
    surface, frames = Surface(mesh, settings.crease_deg), []
    materials = Materials.from_mesh(mesh, tuple(APPEARANCES.values()), settings.albedo)
    share = visible_share(surface, mesh, cameras[~held_out])
    draws = random_streams(0, "part", settings)[0]
    shade = view_shading(surface, materials, settings, draws)
    capture_settings = np.ones(3), settings, draws
    ready, seconds, profile = perf_counter() - start, np.zeros(2), cProfile.Profile()
    for K, c2w, casting in zip(
        cameras.K, cameras.c2w, bare_ray_casting(mesh, cameras), strict=True
    ):
        start = perf_counter()
        frames.append(render_image(surface, shade, K, c2w, *capture_settings))
        seconds += perf_counter() - start, casting
        profile.runcall(render_image, surface, shade, K, c2w, *capture_settings)
    step_mm = (settings.radius + 1) * radius_mm / MAX_DEPTH_VALUE
    backgrounds = np.ones((len(frames), 3))
    views = Views(Path(), "part", cameras, held_out, backgrounds, step_mm, share)
    written, size = write(views, frames)
    rendering, casting = len(frames) / seconds
    row = [len(mesh.faces), 1000 * ready, rendering, casting, rendering / casting]
    row += [1000 * written / len(frames), size / 1e6, ready + seconds[0] + written]
    row += [100 * share for share in shares(profile)]
    return [f"{value:{form}}" for value, form in zip(row, FORMS, strict=True)]


def write(views: Views, frames: list[RgbdImage]) -> tuple[float, int]:
    """Seconds that writing all files of `frames` takes, and the bytes of the pictures."""
    with tempfile.TemporaryDirectory() as folder:
        start = perf_counter()
        save_views(replace(views, folder=Path(folder)), frames)
        seconds = perf_counter() - start
        return seconds, sum(path.stat().st_size for path in Path(folder).iterdir())


def shares(profile: cProfile.Profile) -> list[float]:
    """The share of `render_image` that each of SHARES takes."""
    spent: dict[str, float] = {}
    for (_, _, name), (_, _, _, cumulative, _) in pstats.Stats(profile).stats.items():
        spent[name] = spent.get(name, 0) + cumulative
    return [
        (sum(spent[name] for name in counted) - sum(spent[name] for name in less))
        / spent["render_image"]
        for counted, less in SHARES.values()
    ]


def main(names: list[str]) -> None:
    settings, console = load_params().views, Console(width=190)
    if names[:1] == ["photorealistic"]:
        settings, names = replace(settings, shading="photorealistic"), names[1:]
    views = f"{settings.count + settings.held_out} {settings.shading} views"
    table = Table(title=f"{views}, {settings.resolution} px")
    table.add_column("part")
    for head in HEADS:
        table.add_column(head, justify="right")
    for name, mesh in solids(names):
        if not table.rows:
            measure(mesh, replace(settings, count=2, held_out=1))  # loads the kernels
        table.add_row(name, *measure(mesh, settings))
    console.print(table)


if __name__ == "__main__":
    main(sys.argv[1:])
