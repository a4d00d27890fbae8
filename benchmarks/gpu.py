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
from kernels import DENSITY, NEIGHBORS, REPEATS, SPACING, make_cloud, make_rays, samples_in_box
from method import METHODS, Job, even_emd, load_images, print_row

from industnerf.artifacts.split import load_split
from industnerf.config import load_params
from industnerf.rendering.compiled_renderer import CompiledRenderer
from industnerf.rendering.points import PointGrid
from industnerf.rendering.render import Rays
from industnerf.schema.readings import InterpolationReading

RAY_COUNTS = 4096, 65536, 262144  # rays at a time
READINGS: dict[str, InterpolationReading] = {
    "inverse square, searched": "inverse_square",
    "tents, on a lattice": "trilinear",
}


@dataclass(frozen=True)
class PartRun:
    job: Job
    seconds: float
    peak_mb: float  # of the GPU's memory
    emd: float
    floor: float


def kernels() -> Iterator[tuple[str, ...]]:
    for density, (kind, reading) in [(d, r) for d in DENSITY for r in READINGS.items()]:
        for count in RAY_COUNTS:
            times = {
                device: time_sample(device, density, reading, count) for device in ("cpu", "cuda")
            }
            cells = [f"{t:.3g}" for device in times for t in times[device]]
            ratio = sum(times["cpu"]) / sum(times["cuda"])
            yield density, kind, str(count), *cells, f"{ratio:.0f}"


def time_sample(
    device: str, density: str, reading: InterpolationReading, count: int
) -> tuple[float, float]:
    """Nanoseconds forward and backward, the median of TURNS after one that compiles."""
    point_cloud = make_cloud(1.0, DENSITY[density], jittered=reading != "trilinear")
    points = PointGrid(point_cloud.positions.to(device), point_cloud.radius, NEIGHBORS, reading)
    points.cells.is_grid_aligned = reading == "trilinear"
    renderer = CompiledRenderer(points, (-1.0,) * 3, (1.0,) * 3, SPACING, point_cloud.stop)
    batch = make_rays(count)
    samples = int(samples_in_box(batch)[1].sum())
    device_batch = Rays(*(x.to(device) for x in (batch.origins, batch.directions, batch.offsets)))
    order = points.order.cpu()
    values, rgb = (
        x[order].to(device).requires_grad_() for x in (point_cloud.sigma, point_cloud.rgb)
    )

    def one_turn() -> tuple[float, float]:
        times = [clock(device)]
        output = renderer.render(device_batch, values, rgb)
        times.append(clock(device))
        (output.color.sum() + output.transmittance.sum()).backward()
        times.append(clock(device))
        return times[1] - times[0], times[2] - times[1]

    turns = [one_turn() for _ in range(REPEATS + 1)][1:]
    forward, backward = (1e9 * median(x) / samples for x in zip(*turns, strict=True))
    return forward, backward


def clock(device: str) -> float:
    """Seconds, once the device has done all that it was asked for."""
    if device == "cuda":
        torch.cuda.synchronize()
    return time.perf_counter()


def run_on(device: str, job: Job) -> tuple[float, np.ndarray]:
    """Seconds, and the cloud."""
    from industnerf.methods.industnerf.pipeline import run

    os.environ["INDUSTNERF_DEVICE"] = device
    images = load_images(job)
    start = clock(device)
    points = run(images, job.settings, seed=0).points
    return clock(device) - start, points


def reconstruct(device: str, job: Job) -> PartRun:
    """The same, scored."""
    if device == "cuda":
        torch.cuda.reset_peak_memory_stats()
    seconds, points = run_on(device, job)
    peak = torch.cuda.max_memory_allocated() / 2**20 if device == "cuda" else 0.0
    return PartRun(job, seconds, peak, *even_emd(job, points, load_params().evaluate))


@contextmanager
def processes(count: int, warm_up: Callable, job: Job) -> Iterator[ProcessPoolExecutor]:
    """So many, each with one part behind it."""
    spawn = multiprocessing.get_context("spawn")
    barrier = spawn.Barrier(count)
    with ProcessPoolExecutor(count, spawn, _set_barrier, (barrier,)) as pool:
        list(pool.map(partial(_warm_up_and_wait, warm_up), [job] * count))
        yield pool


def _set_barrier(barrier: Barrier) -> None:
    """Where `_warmed` finds it: only at its start can a process be given a barrier."""
    global shared_barrier
    shared_barrier = barrier


def _warm_up_and_wait(warm_up: Callable, job: Job) -> None:
    """Wait for all others, so that none has two."""
    warm_up(job)
    shared_barrier.wait()


def parts(jobs: Sequence[Job]) -> Iterator[tuple[str, ...]]:
    """A row a part, then the mean."""
    runs = {}
    for device, count in {"cuda": 1, "cpu": len(os.sched_getaffinity(0))}.items():
        with processes(count, partial(reconstruct, device), jobs[0]) as pool:
            runs[device] = list(pool.map(partial(reconstruct, device), jobs))
    for cpu, gpu in zip(runs["cpu"], runs["cuda"], strict=True):
        yield cpu.job.method, cpu.job.part, *compare_runs([cpu], [gpu])
    for method in METHODS:
        yield (
            method,
            "mean",
            *compare_runs(of_method(method, runs["cpu"]), of_method(method, runs["cuda"])),
        )


def of_method(method: str, runs: Sequence[PartRun]) -> list[PartRun]:
    return [run for run in runs if run.job.method == method]


def compare_runs(cpu: Sequence[PartRun], gpu: Sequence[PartRun]) -> Iterator[str]:
    for runs in (cpu, gpu):
        yield f"{fmean(run.seconds for run in runs):.1f}"
    yield f"{max(run.peak_mb for run in gpu):.0f}"
    yield f"{fmean(run.floor for run in cpu):.5f}"
    emds = [fmean(run.emd for run in runs) for runs in (cpu, gpu)]
    yield from (f"{emd:.5f}" for emd in emds)
    yield f"{emds[1] / emds[0] - 1:+.1%}"


def share_gpu(jobs: Sequence[Job], counts: Sequence[int]) -> Iterator[tuple[str, ...]]:
    for method in METHODS:
        method_jobs = [job for job in jobs if job.method == method]
        for count in counts:
            with processes(count, partial(run_on, "cuda"), method_jobs[0]) as pool:
                start = time.perf_counter()
                seconds = [
                    part_seconds
                    for part_seconds, _ in pool.map(partial(run_on, "cuda"), method_jobs)
                ]
                total_seconds = time.perf_counter() - start
            yield (
                method,
                str(count),
                f"{total_seconds / len(method_jobs):.2f}",
                f"{median(seconds):.1f}",
            )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("data", type=Path)
    parser.add_argument("--parts", nargs="+")
    parser.add_argument("--workers", nargs="+", type=int, default=[4, 8])
    arguments, method_settings = parser.parse_args(), load_params().method
    assignments = load_split(arguments.data / "split.json")
    names = arguments.parts or [
        part for part, assignment in assignments.items() if assignment.split == "dev"
    ]
    jobs = [
        Job(arguments.data, part, name, getattr(method_settings, name))
        for name in METHODS
        for part in names
    ]
    print(torch.cuda.get_device_name(), "torch", torch.__version__)
    kernel_headers = "CPU ->", "CPU <-", "GPU ->", "GPU <-", "times"
    part_headers = "CPU s", "GPU s", "MB", "floor", "CPU EMD", "GPU EMD", "off"
    tables = {
        ("density", "weights", "rays", *kernel_headers): kernels(),
        ("method", "part", *part_headers): parts(jobs),
        ("method", "processes", "s a part", "s in a process"): share_gpu(jobs, arguments.workers),
    }
    for heads, rows in tables.items():
        print_row(*heads)
        print_row(*["---"] * len(heads))
        for row in rows:
            print_row(*row)
        print()


if __name__ == "__main__":
    main()
