"""What does the paper's method cost, and what does more time buy?

OMP_NUM_THREADS=1 python benchmarks/method.py DATA [--methods ...] [--parts ...] [--tables ...]

DATA is the folder `data` of a finished run, of which `parts`, `views` and `truth` are read.
Tables `grid_res`, `views`, `image_size` (px) and `points` vary one thing, the rest is as in
params.yaml; images scaled down take the levels' `image_px` down with them.  `budget` scales all
numbers of steps so that a part takes about so many seconds, and scores the cloud (P1-even).
`shares` says where the time of a run goes: what a line calls counts for itself if it has a line.

Every run has a process of its own; seconds are the processor's, `peak MB` is all of its memory.
"""

import argparse
import math
import multiprocessing
import resource
from collections import Counter
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from itertools import product
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np
from PIL import Image

from industnerf.artifacts.part import load_mesh
from industnerf.artifacts.truth import Truth
from industnerf.artifacts.views import load_views
from industnerf.config import load_params
from industnerf.geometry.cameras import Cameras, framed_ball
from industnerf.metrics.emd import emd
from industnerf.metrics.reduce import farthest_points, random_points
from industnerf.metrics.visible import Frame, Rig, scored
from industnerf.schema import EvaluateParams, IndustnerfSettings

METHODS = ["industnerf", "industnerf_plus"]
PARTS = ["bearing-angular-7304", "collet-er32-d12", "ballscrew-nut-sfu1605"]
BUDGETS = (10, 30, 60, 150)  # seconds a part
NEAR, TRIES = 0.2, 4  # a run this close to its budget, or so many of them, are enough
VALUES = {
    "grid_res": (32, 48, 64, 96),
    "views": (5, 10, 20, 40),
    "image_size": (64, 128, 256, 512),
    "points": (25_000, 50_000, 100_000, 200_000),  # of levels after the first
}


@dataclass(frozen=True)
class Job:
    """One reconstruction."""

    data: Path
    part: str
    method: str
    settings: IndustnerfSettings
    views: int | None = None  # None: all
    side: int | None = None  # px; None: as photographed


@dataclass(frozen=True)
class Done:
    seconds: float
    peak_mb: float
    steps: int
    points: np.ndarray
    shares: Counter


def posed(job: Job) -> Any:
    """The photographs that the method is given."""
    from industnerf.methods.industnerf.scene import Posed

    views = load_views(job.data / "views" / job.part)
    which = views.train
    if job.views:
        which = which[np.linspace(0, len(which) - 1, job.views).round().astype(int)]
    rgb, cameras = views.rgb(which), views.cameras[which]
    if job.side:
        rgb, cameras = smaller(rgb, cameras, job.side)
    known = views.background[which] if job.method == "industnerf_plus" else None
    return Posed(rgb, cameras, known, *framed_ball(cameras))


def smaller(rgb: np.ndarray, cameras: Cameras, side: int) -> tuple[np.ndarray, Cameras]:
    """The images `side` px wide, each pixel the mean of those that it stands for."""
    images = [Image.fromarray(image).resize((side, side), Image.Resampling.BOX) for image in rgb]
    K = cameras.K.copy()
    K[:, :2] *= side / cameras.width
    return np.stack([np.asarray(image) for image in images]), Cameras(K, cameras.c2w, side, side)


def reconstruct(job: Job) -> Done:
    from industnerf.methods.industnerf.run import run

    given, clock = posed(job), Clock()
    with clocked(clock):
        start = process_time()
        outcome = run(given, job.settings, seed=0)
        seconds = process_time() - start
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024  # kB on Linux
    clock.spent["rest"] = seconds - sum(clock.spent.values())
    return Done(seconds, peak, outcome.steps, outcome.points, clock.spent)


def alone(job: Job) -> Done:
    """`reconstruct` in a new process."""
    with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
        return pool.submit(reconstruct, job).result()


class Clock:
    """Processor seconds by label; what runs inside another label is taken from that."""

    def __init__(self) -> None:
        self.spent: Counter = Counter()
        self._open: list[str] = []
        self._last = 0.0

    def timed(self, label: str, function: Callable) -> Callable:
        def call(*args: Any, **named: Any) -> Any:
            self._turn()
            self._open.append(label)
            try:
                return function(*args, **named)
            finally:
                self._turn()
                self._open.pop()

        return call

    def _turn(self) -> None:
        now = process_time()
        if self._open:
            self.spent[self._open[-1]] += now - self._last
        self._last = now


@contextmanager
def clocked(clock: Clock) -> Iterator[None]:
    """The steps of the method, told apart."""
    import torch

    from industnerf.methods.industnerf.field import Field
    from industnerf.methods.industnerf.pixels import Pixels
    from industnerf.methods.industnerf.sources import Sources
    from industnerf.methods.industnerf.training import Training
    from industnerf.rendering.render import Renderer

    places = [
        ("place points", Training, "__init__"),
        ("draw rays", Pixels, "draw"),
        ("encode views", Sources, "refresh"),
        ("field", Field, "forward"),
        ("render", Renderer, "_forward"),
        ("backward, all but rendering", torch.Tensor, "backward"),
        ("render, backward", Renderer, "_backward"),
        ("Adam", torch.optim.Adam, "step"),
        ("sweep", Training, "_sweep"),
        ("testimony", Training, "testimony"),
    ]
    before = [(owner, name, getattr(owner, name)) for _, owner, name in places]
    for (label, *_), (owner, name, function) in zip(places, before, strict=True):
        setattr(owner, name, clock.timed(label, function))
    try:
        yield
    finally:
        for owner, name, function in before:
            setattr(owner, name, function)


def even_emd(job: Job, points: np.ndarray, ways: EvaluateParams) -> tuple[float, float]:
    """EMD under P1-even, and its floor."""
    known = Truth.load(job.data / "truth" / job.part)
    frame = Frame(load_mesh(job.data / "parts" / job.part))
    points = random_points(points.astype(float), ways.cap, np.random.default_rng(0))
    truth = known.points_mm.astype(float)
    kept = scored(Rig(frame, ways), points, truth, known.visible, ways.hidden)
    a, b = frame.unit(truth[known.visible]), frame.unit(points[kept])
    value = emd(farthest_points(a, ways.points), farthest_points(b, ways.points))
    return value, known.floors["emd P1-even"]


def varied(job: Job, what: str, value: int) -> Job:
    """`job` with `what` at `value`."""
    ways, levels = job.settings, job.settings.levels
    match what:
        case "grid_res":
            return replace(job, settings=replace(ways, grid_res=value))
        case "views":
            return replace(job, views=value)
        case "image_size":
            warm_up, *levels = [
                replace(x, image_px=max(16, x.image_px * value // 512))
                for x in (ways.warm_up, *levels)
            ]
            return replace(job, settings=replace(ways, warm_up=warm_up, levels=levels), side=value)
        case _:
            levels = [levels[0], *(replace(x, points=value) for x in levels[1:])]
            return replace(job, settings=replace(ways, levels=levels))


def stretched(job: Job, factor: float) -> Job:
    """`job` with `factor` times the steps."""
    ways = job.settings
    levels = [replace(x, steps=math.ceil(factor * x.steps)) for x in ways.levels]
    warm_up = replace(ways.warm_up, steps=round(factor * ways.warm_up.steps))
    recolour = replace(ways.recolour, steps=round(factor * ways.recolour.steps))
    return replace(job, settings=replace(ways, warm_up=warm_up, levels=levels, recolour=recolour))


def cost(what: str, job: Job, first: int | None) -> Iterator[tuple[str, ...]]:
    """A row for each value of `what`."""
    if what == "points" and job.settings.refine == "divided":
        return  # there the grid decides how many
    for value in VALUES[what][:first]:
        done = alone(varied(job, what, value))
        yield str(value), f"{done.seconds:.1f}", f"{done.peak_mb:.0f}", str(len(done.points))


def budget(job: Job, first: int | None) -> Iterator[tuple[str, ...]]:
    ways, usual = load_params().evaluate, alone(job).seconds
    for seconds in BUDGETS[:first]:
        done = within(job, seconds, seconds / usual)
        value, floor = even_emd(job, done.points, ways)
        numbers = f"{done.steps}", f"{done.seconds:.1f}", f"{value:.5f}", f"{value / floor:.2f}"
        yield str(seconds), *numbers


def within(job: Job, seconds: float, factor: float) -> Done:
    """`job` with about the steps that take `seconds`; the first steps cost more than the last."""
    for _ in range(TRIES):
        done = alone(stretched(job, factor))
        if abs(done.seconds / seconds - 1) < NEAR:
            break
        factor *= seconds / done.seconds
    return done


def shares(job: Job, first: int | None) -> Iterator[tuple[str, ...]]:
    done = alone(job)
    for what, seconds in done.shares.most_common(first):
        numbers = seconds, 1000 * seconds / done.steps, 100 * seconds / done.seconds
        yield what, *(f"{number:.1f}" for number in numbers)


TABLES = {what: (partial(cost, what), (what, "s", "peak MB", "points out")) for what in VALUES} | {
    "budget": (budget, ("budget s", "steps", "s", "EMD", "/ floor")),
    "shares": (shares, ("what", "s", "ms a step", "%")),
}


def show(*cells: str) -> None:
    """A row at once: the next may take minutes."""
    print(f"| {' | '.join(cells)} |", flush=True)


def main(argv: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("data", type=Path)
    parser.add_argument("--methods", nargs="+", choices=METHODS, default=METHODS)
    parser.add_argument("--parts", nargs="+", default=PARTS)
    parser.add_argument("--tables", nargs="+", choices=TABLES, default=list(TABLES))
    parser.add_argument("--first", type=int, help="only so many rows of each table and part")
    given, known = parser.parse_args(argv), load_params().method
    for rows, heads in (TABLES[name] for name in given.tables):
        show("method", "part", *heads)
        show(*["---"] * (2 + len(heads)))
        for method, part in product(given.methods, given.parts):
            job = Job(given.data, part, method, getattr(known, method))
            for row in rows(job, given.first):
                show(method, part, *row)
        print()


if __name__ == "__main__":
    main()
