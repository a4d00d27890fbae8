"""What does it cost to score a cloud, near the truth and far from it?

python benchmarks/scoring.py [part ...]     ids of embedded parts; without any, a choice

Seconds of the processor (set OMP_NUM_THREADS=1).  `neighbours` are both ways between a cloud and
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
from industnerf.geometry.closest import distance_to_surface
from industnerf.geometry.sampling import sample_surface
from industnerf.geometry.shapes import ball_surface, box_surface
from industnerf.metrics.emd import emd
from industnerf.metrics.gaps import between
from industnerf.metrics.reduce import farthest_points

HEADS = ["part", "cloud", "EMD s", "surface s", "neighbours s", "scipy s", "times"]


def seconds(work: Callable[[], Any]) -> float:
    start = process_time()
    work()
    return process_time() - start


def clouds_of(mesh: Mesh, count: int) -> dict[str, np.ndarray]:
    """The truth and clouds ever farther from it, in diagonals."""
    rng = np.random.default_rng(0)
    box = np.ptp(mesh.vertices, axis=0), mesh.vertices.mean(axis=0), count, rng
    truth, again = (sample_surface(mesh.vertices, mesh.faces, count, rng)[0] for _ in range(2))
    noise = 0.02 * np.linalg.norm(box[0]) * rng.standard_normal(again.shape)
    found = {"truth": truth, "resampled": again, "noise 2 %": again + noise}
    found |= {"box": box_surface(*box), "ball": ball_surface(*box)}
    return {name: cloud / np.linalg.norm(box[0]) for name, cloud in found.items()}


def by_scipy(a: np.ndarray, b: np.ndarray) -> None:
    cKDTree(a).query(b)
    cKDTree(b).query(a)


def measure(mesh: Mesh, truth: np.ndarray, cloud: np.ndarray, points: int) -> list[str]:
    """One row, but for the names."""
    corners = mesh.vertices / np.linalg.norm(np.ptp(mesh.vertices, axis=0))
    few = farthest_points(truth, points), farthest_points(cloud, points)
    spent = [
        seconds(lambda: emd(*few)),
        seconds(lambda: distance_to_surface(cloud, corners, mesh.faces)),
        seconds(lambda: between(truth, cloud)),
        seconds(lambda: by_scipy(truth, cloud)),
    ]
    return [*(f"{value:.2f}" for value in spent), f"{spent[3] / spent[2]:.1f}"]


def main(names: list[str]) -> None:
    settings, table = load_params().evaluate, Table(title="one cloud")
    for head in HEADS:
        table.add_column(head, justify="left" if head in ("part", "cloud") else "right")
    for name, mesh in solids(names):
        clouds = clouds_of(mesh, settings.cap)
        truth = clouds.pop("truth")
        for kind, cloud in clouds.items():
            table.add_row(name, kind, *measure(mesh, truth, cloud, settings.points))
    Console(width=120).print(table)


if __name__ == "__main__":
    main(sys.argv[1:])
