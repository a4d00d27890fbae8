"""What does it cost to score a cloud, near the truth and far from it?

python benchmarks/scoring.py [part ...]     ids of embedded parts; without any, a choice

Seconds of the processor (set OMP_NUM_THREADS=1).  `neighbors` are both ways between a cloud and
the truth, 65536 points each, as scoring finds them; `scipy` finds the same with SciPy's tree.
"""

import sys
from collections.abc import Callable
from time import process_time
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table
from scipy.spatial import cKDTree
from solids import solids

from industnerf.artifacts.part import Mesh
from industnerf.config import load_params
from industnerf.geometry.sampling import ball_surface, box_surface, sample_surface
from industnerf.geometry.surface_distance import distance_to_surface
from industnerf.metrics.emd import emd
from industnerf.metrics.nearest_distances import nearest_distances
from industnerf.metrics.subsample import farthest_points

HEADS = ["part", "cloud", "EMD s", "surface s", "neighbors s", "scipy s", "times"]


def seconds(task: Callable[[], Any]) -> float:
    start = process_time()
    task()
    return process_time() - start


def clouds_of(mesh: Mesh, count: int) -> dict[str, np.ndarray]:
    """The truth and clouds ever farther from it, in diagonals."""
    rng = np.random.default_rng(0)
    box = np.ptp(mesh.vertices, axis=0), mesh.vertices.mean(axis=0), count, rng
    truth, resampled = (sample_surface(mesh.vertices, mesh.faces, count, rng)[0] for _ in range(2))
    noise = 0.02 * np.linalg.norm(box[0]) * rng.standard_normal(resampled.shape)
    clouds = {"truth": truth, "resampled": resampled, "noise 2 %": resampled + noise}
    clouds |= {"box": box_surface(*box), "ball": ball_surface(*box)}
    return {name: cloud / np.linalg.norm(box[0]) for name, cloud in clouds.items()}


def by_scipy(a: np.ndarray, b: np.ndarray) -> None:
    cKDTree(a).query(b)
    cKDTree(b).query(a)


def measure(mesh: Mesh, truth: np.ndarray, cloud: np.ndarray, points: int) -> list[str]:
    """One row, but for the names."""
    corners = mesh.vertices / np.linalg.norm(np.ptp(mesh.vertices, axis=0))
    even_points = farthest_points(truth, points), farthest_points(cloud, points)
    seconds_spent = [
        seconds(lambda: emd(*even_points)),
        seconds(lambda: distance_to_surface(cloud, corners, mesh.faces)),
        seconds(lambda: nearest_distances(truth, cloud)),
        seconds(lambda: by_scipy(truth, cloud)),
    ]
    return [
        *(f"{value:.2f}" for value in seconds_spent),
        f"{seconds_spent[3] / seconds_spent[2]:.1f}",
    ]


def main(names: list[str]) -> None:
    settings, table = load_params().evaluate, Table(title="one cloud")
    for head in HEADS:
        table.add_column(head, justify="left" if head in ("part", "cloud") else "right")
    for name, mesh in solids(names):
        clouds = clouds_of(mesh, settings.max_points)
        truth = clouds.pop("truth")
        for kind, cloud in clouds.items():
            table.add_row(name, kind, *measure(mesh, truth, cloud, settings.points))
    Console(width=120).print(table)


if __name__ == "__main__":
    main(sys.argv[1:])
