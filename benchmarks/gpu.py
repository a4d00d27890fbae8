"""What does a GPU gain over one core, and does it find the same?

OMP_NUM_THREADS=1 python benchmarks/gpu.py DATA [--parts ...] [--workers 4 8]

DATA is the folder `data` of a finished run, of which `parts`, `views` and `truth` are read.
First the kernels of benchmarks/kernels.py: nanoseconds a sample of the rays in the box, forward
and backward, by the number of rays at a time.  Then parts, by default all dev parts of DATA: EMD
(P1-even) and seconds by the clock, on the GPU one part after the other in a process that has had
one before, on the CPU one thread each on all cores; `MB` is the most that torch had of the GPU's
memory.  Last the seconds a part when so many processes share the GPU, each with one part
behind it.
"""

import argparse
import multiprocessing
import os
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from multiprocessing.synchronize import Barrier
from pathlib import Path
from statistics import fmean, median

import numpy as np
import torch
from kernels import DENSITY, NEIGHBOURS, SPACING, TURNS, cloud, inside, rays
from method import METHODS, Job, even_emd, posed, show

from industnerf.artifacts.split import load_split
from industnerf.config import load_params
from industnerf.rendering.points import Points
from industnerf.rendering.render import Rays, Renderer
from industnerf.schema.readings import WeightReading

COUNTS = 4096, 65536, 262144  # rays at a time
READINGS: dict[str, WeightReading] = {
    "inverse square, searched": "inverse_square",
    "tents, on a lattice": "tent",
}


@dataclass(frozen=True)
class Done:
    job: Job
    seconds: float
    peak_mb: float  # of the GPU's memory
    emd: float
    floor: float


def kernels() -> Iterator[tuple[str, ...]]:
    for density, (kind, reading) in [(d, r) for d in DENSITY for r in READINGS.items()]:
        for count in COUNTS:
            ways = {where: a_sample(where, density, reading, count) for where in ("cpu", "cuda")}
            cells = [f"{t:.3g}" for where in ways for t in ways[where]]
            ratio = sum(ways["cpu"]) / sum(ways["cuda"])
            yield density, kind, str(count), *cells, f"{ratio:.0f}"


def a_sample(where: str, density: str, reading: WeightReading, count: int) -> tuple[float, float]:
    """Nanoseconds forward and backward, the median of TURNS after one that compiles."""
    given = cloud(1.0, DENSITY[density], shaken=reading != "tent")
    points = Points(given.positions.to(where), given.radius, NEIGHBOURS, reading)
    points.cells.lattice = reading == "tent"
    renderer = Renderer(points, (-1.0,) * 3, (1.0,) * 3, SPACING, given.stop)
    some = rays(count)
    samples = int(inside(some)[1].sum())
    here = Rays(*(x.to(where) for x in (some.origins, some.directions, some.offsets)))
    order = points.order.cpu()
    values, rgb = (x[order].to(where).requires_grad_() for x in (given.sigma, given.rgb))

    def turn() -> tuple[float, float]:
        times = [clock(where)]
        seen = renderer.look(here, values, rgb)
        times.append(clock(where))
        (seen.colour.sum() + seen.through.sum()).backward()
        times.append(clock(where))
        return times[1] - times[0], times[2] - times[1]

    turns = [turn() for _ in range(TURNS + 1)][1:]
    ahead, back = (1e9 * median(x) / samples for x in zip(*turns, strict=True))
    return ahead, back


def clock(where: str) -> float:
    """Seconds, once the device has done all that it was asked for."""
    if where == "cuda":
        torch.cuda.synchronize()
    return time.perf_counter()


def run_on(where: str, job: Job) -> tuple[float, np.ndarray]:
    """Seconds, and the cloud."""
    from industnerf.methods.industnerf.run import run

    os.environ["INDUSTNERF_DEVICE"] = where
    given = posed(job)
    start = clock(where)
    points = run(given, job.settings, seed=0).points
    return clock(where) - start, points


def reconstruct(where: str, job: Job) -> Done:
    """The same, scored."""
    if where == "cuda":
        torch.cuda.reset_peak_memory_stats()
    seconds, points = run_on(where, job)
    peak = torch.cuda.max_memory_allocated() / 2**20 if where == "cuda" else 0.0
    return Done(job, seconds, peak, *even_emd(job, points, load_params().evaluate))


@contextmanager
def processes(count: int, warm_up: Callable, job: Job) -> Iterator[ProcessPoolExecutor]:
    """So many, each with one part behind it."""
    spawn = multiprocessing.get_context("spawn")
    barrier = spawn.Barrier(count)
    with ProcessPoolExecutor(count, spawn, _remember, (barrier,)) as pool:
        list(pool.map(partial(_warmed, warm_up), [job] * count))
        yield pool


def _remember(barrier: Barrier) -> None:
    """Where `_warmed` finds it: only at its start can a process be given a barrier."""
    global everyone
    everyone = barrier


def _warmed(warm_up: Callable, job: Job) -> None:
    """Wait for all others, so that none has two."""
    warm_up(job)
    everyone.wait()


def parts(jobs: Sequence[Job]) -> Iterator[tuple[str, ...]]:
    """A row a part, then the mean."""
    done = {}
    for where, count in {"cuda": 1, "cpu": len(os.sched_getaffinity(0))}.items():
        with processes(count, partial(reconstruct, where), jobs[0]) as pool:
            done[where] = list(pool.map(partial(reconstruct, where), jobs))
    for cpu, gpu in zip(done["cpu"], done["cuda"], strict=True):
        yield cpu.job.method, cpu.job.part, *compared([cpu], [gpu])
    for method in METHODS:
        yield method, "mean", *compared(of(method, done["cpu"]), of(method, done["cuda"]))


def of(method: str, some: Sequence[Done]) -> list[Done]:
    return [one for one in some if one.job.method == method]


def compared(cpu: Sequence[Done], gpu: Sequence[Done]) -> Iterator[str]:
    for some in (cpu, gpu):
        yield f"{fmean(one.seconds for one in some):.1f}"
    yield f"{max(one.peak_mb for one in gpu):.0f}"
    yield f"{fmean(one.floor for one in cpu):.5f}"
    emds = [fmean(one.emd for one in some) for some in (cpu, gpu)]
    yield from (f"{emd:.5f}" for emd in emds)
    yield f"{emds[1] / emds[0] - 1:+.1%}"


def shared(jobs: Sequence[Job], counts: Sequence[int]) -> Iterator[tuple[str, ...]]:
    for method in METHODS:
        some = [job for job in jobs if job.method == method]
        for count in counts:
            with processes(count, partial(run_on, "cuda"), some[0]) as pool:
                start = time.perf_counter()
                seconds = [took for took, _ in pool.map(partial(run_on, "cuda"), some)]
                whole = time.perf_counter() - start
            yield method, str(count), f"{whole / len(some):.2f}", f"{median(seconds):.1f}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("data", type=Path)
    parser.add_argument("--parts", nargs="+")
    parser.add_argument("--workers", nargs="+", type=int, default=[4, 8])
    given, known = parser.parse_args(), load_params().method
    places = load_split(given.data / "split.json")
    names = given.parts or [part for part, place in places.items() if place.split == "dev"]
    jobs = [Job(given.data, part, name, getattr(known, name)) for name in METHODS for part in names]
    print(torch.cuda.get_device_name(), "torch", torch.__version__)
    ways = "CPU ->", "CPU <-", "GPU ->", "GPU <-", "times"
    both = "CPU s", "GPU s", "MB", "floor", "CPU EMD", "GPU EMD", "off"
    tables = {
        ("density", "weights", "rays", *ways): kernels(),
        ("method", "part", *both): parts(jobs),
        ("method", "processes", "s a part", "s in a process"): shared(jobs, given.workers),
    }
    for heads, rows in tables.items():
        show(*heads)
        show(*["---"] * len(heads))
        for row in rows:
            show(*row)
        print()


if __name__ == "__main__":
    main()
