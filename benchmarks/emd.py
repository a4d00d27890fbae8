"""How long does one exact EMD take, by column generation, against POT on all pairs?

OMP_NUM_THREADS=1 python benchmarks/emd.py [--squared] [points ...]     4096 and 8192 by default

Clouds are sampled from simple solids scaled to diagonal 1.  Either way runs in a process of its
own, one after the other; seconds are the processor's, which a busy machine stretches least.
`floor` is the EMD of two independent even samples; good means below twice that.  `--squared`: by
the square of the distance; good is then below four times the floor.  Beyond 8192 points the dense
problem is left out.
"""

import argparse
import multiprocessing
import os
import resource
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from time import process_time

import numpy as np
import trimesh
from rich.console import Console
from rich.table import Table
from scipy.spatial.distance import cdist
from trimesh import creation

from industnerf.metrics.emd import emd
from industnerf.metrics.subsample import farthest_points

MAX_DENSE = 8192  # points; of 16384 the dense problem takes 12 GB
OVERSAMPLED = 8  # samples per even point
Solver = Callable[[np.ndarray, np.ndarray], float]


@dataclass(frozen=True)
class Pair:
    name: str
    a: np.ndarray
    b: np.ndarray


@dataclass(frozen=True)
class SolverRun:
    value: float
    seconds: float
    peak_mb: float


def flange() -> trimesh.Trimesh:
    neck = creation.annulus(0.15, 0.25, 0.5).apply_translation([0, 0, 0.25])
    return trimesh.util.concatenate([creation.annulus(0.15, 0.5, 0.12), neck])


def to_unit_diagonal(solid: trimesh.Trimesh) -> trimesh.Trimesh:
    centered = solid.copy().apply_translation(-solid.bounds.mean(axis=0))
    return centered.apply_scale(1 / centered.scale)


def area_samples(solid: trimesh.Trimesh, n: int, seed: int) -> np.ndarray:
    return np.asarray(trimesh.sample.sample_surface(solid, n, seed=seed)[0])


def even_samples(solid: trimesh.Trimesh, n: int, seed: int, noise: float = 0.0) -> np.ndarray:
    points = area_samples(solid, OVERSAMPLED * n, seed)
    return farthest_points(points + np.random.default_rng(seed).normal(0, noise, points.shape), n)


def pairs(n: int) -> Iterator[Pair]:
    """From the truth against itself to a ball in its place; the truth is always `b`."""
    for name, solid in {"torus": creation.torus(1, 0.3), "box": creation.box((3, 2, 1))}.items():
        part = to_unit_diagonal(solid)
        yield from good_pairs(name, part, even_samples(part, n, 0))
    part = to_unit_diagonal(flange())
    truth = even_samples(part, n, 0)
    yield from good_pairs("flange", part, truth)
    yield from poor_pairs("flange", part, truth)


def good_pairs(name: str, part: trimesh.Trimesh, truth: np.ndarray) -> Iterator[Pair]:
    n = len(truth)
    yield Pair(f"{name}: resampled", even_samples(part, n, 1), truth)
    yield Pair(f"{name}: resampled, noise 0.3 %", even_samples(part, n, 1, 0.003), truth)
    yield Pair(f"{name}: iid sample", area_samples(part, n, 1), truth)
    yield Pair(f"{name}: 3/4 of the points", even_samples(part, 3 * n // 4, 1), truth)
    yield Pair(f"{name}: 10 % moved by 1 %", partly_moved(truth), truth)


def poor_pairs(name: str, part: trimesh.Trimesh, truth: np.ndarray) -> Iterator[Pair]:
    n = len(truth)
    yield Pair(f"{name}: noise 2 %", even_samples(part, n, 1, 0.02), truth)
    yield Pair(f"{name}: shifted 5 %", even_samples(part, n, 1) + np.array([0.05, 0, 0]), truth)
    yield Pair(
        f"{name}: one third missing", without_a_third(even_samples(part, 2 * n, 1), n), truth
    )
    yield Pair(f"{name}: its box", even_samples(creation.box(part.extents), n, 1), truth)
    yield Pair(f"{name}: a ball", even_samples(creation.icosphere(4, 0.25), n, 1), truth)
    yield Pair(f"{name}: far off", even_samples(part, n, 1) + np.array([3.0, 2, 1]), truth)


def partly_moved(points: np.ndarray) -> np.ndarray:
    rng = np.random.default_rng(2)
    return points + (rng.random((len(points), 1)) < 0.1) * rng.normal(0, 0.01, points.shape)


def without_a_third(points: np.ndarray, n: int) -> np.ndarray:
    kept = points[points[:, 0] < np.quantile(points[:, 0], 2 / 3)]
    return farthest_points(kept, n)


def sparse_value(a: np.ndarray, b: np.ndarray, *, squared: bool = False) -> float:
    return emd(a, b, squared=squared).value


def dense(a: np.ndarray, b: np.ndarray, *, metric: str = "euclidean") -> float:
    """What one would write without this suite."""
    os.environ["POT_BACKEND_DISABLE_PYTORCH"] = "1"  # torch would only swell the memory
    import ot

    weights = np.full(len(a), 1 / len(a)), np.full(len(b), 1 / len(b))
    value, log = ot.emd2(*weights, cdist(a, b, metric), numItermax=10**9, log=True)
    assert log["warning"] is None, log["warning"]
    return float(value)


def time_solver(solve: Solver, a: np.ndarray, b: np.ndarray) -> SolverRun:
    solve(a[:300], b[:300])  # imports
    start = process_time()
    value = solve(a, b)
    seconds = process_time() - start
    return SolverRun(value, seconds, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)


def run_in_subprocess(solve: Solver, pair: Pair) -> SolverRun:
    """`time_solver` in a fresh process."""
    spawn = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(1, mp_context=spawn) as pool:
        return pool.submit(time_solver, solve, pair.a, pair.b).result()


def table(n: int, sparse_solver: Solver, dense_solver: Solver) -> Table:
    columns = ["clouds", "EMD", "/ floor", "s", "dense s", "times", "rel. difference"]
    result = Table(*columns, "MB", "dense MB", title=f"{n} points")
    floor = np.nan
    for pair in pairs(n):
        sparse = run_in_subprocess(sparse_solver, pair)
        full = run_in_subprocess(dense_solver, pair) if n <= MAX_DENSE else None
        if pair.name.endswith(": resampled"):
            floor = sparse.value
        result.add_row(
            pair.name,
            f"{sparse.value:.5g}",
            f"{sparse.value / floor:.2f}",
            f"{sparse.seconds:.2f}",
            f"{full.seconds:.2f}" if full else "",
            f"{full.seconds / sparse.seconds:.1f}" if full else "",
            f"{sparse.value / full.value - 1:+.0e}" if full else "",
            f"{sparse.peak_mb:.0f}",
            f"{full.peak_mb:.0f}" if full else "",
        )
    return result


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("points", type=int, nargs="*", default=[4096, 8192])
    parser.add_argument("--squared", action="store_true")
    arguments = parser.parse_args()
    solvers = sparse_value, dense
    if arguments.squared:
        solvers = partial(sparse_value, squared=True), partial(dense, metric="sqeuclidean")
    for points in arguments.points:
        Console(width=120).print(table(points, *solvers))


if __name__ == "__main__":
    main()
