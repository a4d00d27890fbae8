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
from importlib import import_module
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
from industnerf.geometry.cameras import Cameras, common_view_ball
from industnerf.metrics.emd import emd
from industnerf.metrics.reference_rig import ReferenceRig, ReferenceSurface, evaluated_mask
from industnerf.metrics.subsample import farthest_points, random_points
from industnerf.schema import EvaluateParams, IndustnerfSettings

METHODS = ["industnerf", "industnerf_plus"]
PARTS = ["bearing-angular-7304", "collet-er32-d12", "ballscrew-nut-sfu1605"]
BUDGETS = (10, 30, 60, 150)  # seconds a part
BUDGET_TOLERANCE, MAX_TRIES = (
    0.2,
    4,
)  # a run this close to its budget, or so many of them, are enough
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
    image_px: int | None = None  # px; None: as photographed


@dataclass(frozen=True)
class JobResult:
    seconds: float
    peak_mb: float
    steps: int
    points: np.ndarray
    shares: Counter


def load_images(job: Job) -> Any:
    """The photographs that the method is given."""
    from industnerf.methods.industnerf.scene import PosedImages

    views = load_views(job.data / "views" / job.part)
    view_ids = views.train_indices
    if job.views:
        view_ids = view_ids[np.linspace(0, len(view_ids) - 1, job.views).round().astype(int)]
    rgb, cameras = views.rgb(view_ids), views.cameras[view_ids]
    if job.image_px:
        rgb, cameras = resize_images(rgb, cameras, job.image_px)
    backgrounds = views.background[view_ids] if job.method == "industnerf_plus" else None
    return PosedImages(rgb, cameras, backgrounds, *common_view_ball(cameras))


def resize_images(rgb: np.ndarray, cameras: Cameras, image_px: int) -> tuple[np.ndarray, Cameras]:
    """The images `side` px wide, each pixel the mean of those that it stands for."""
    images = [
        Image.fromarray(image).resize((image_px, image_px), Image.Resampling.BOX) for image in rgb
    ]
    K = cameras.K.copy()
    K[:, :2] *= image_px / cameras.width
    return np.stack([np.asarray(image) for image in images]), Cameras(
        K, cameras.c2w, image_px, image_px
    )


def reconstruct(job: Job) -> JobResult:
    run = import_module(f"industnerf.methods.{job.method}.pipeline").run
    images, clock = load_images(job), Clock()
    with profile_steps(clock):
        start = process_time()
        outcome = run(images, job.settings, seed=0)
        seconds = process_time() - start
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024  # kB on Linux
    clock.spent["rest"] = seconds - sum(clock.spent.values())
    return JobResult(seconds, peak, outcome.steps, outcome.points, clock.spent)


def run_in_subprocess(job: Job) -> JobResult:
    """`reconstruct` in a new process."""
    with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
        return pool.submit(reconstruct, job).result()


class Clock:
    """Processor seconds by label; what runs inside another label is taken from that."""

    def __init__(self) -> None:
        self.spent: Counter = Counter()
        self._open: list[str] = []
        self._last = 0.0

    def wrap(self, label: str, function: Callable) -> Callable:
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
def profile_steps(clock: Clock) -> Iterator[None]:
    """The steps of the method, told apart."""
    import torch

    from industnerf.methods.industnerf.field import Field
    from industnerf.methods.industnerf.ray_sampler import RaySampler
    from industnerf.methods.industnerf.source_features import SourceFeatures
    from industnerf.methods.industnerf.trainer import Trainer
    from industnerf.rendering.compiled_renderer import CompiledRenderer

    timed_methods = [
        ("place points", Trainer, "__init__"),
        ("draw rays", RaySampler, "sample_pixels"),
        ("encode views", SourceFeatures, "refresh_views"),
        ("field", Field, "forward"),
        ("render", CompiledRenderer, "_forward"),
        ("backward, all but rendering", torch.Tensor, "backward"),
        ("render, backward", CompiledRenderer, "_backward"),
        ("Adam", torch.optim.Adam, "step"),
        ("prune", Trainer, "_prune_empty"),
        ("confidence", Trainer, "view_confidence"),
    ]
    original_methods = [(owner, name, getattr(owner, name)) for _, owner, name in timed_methods]
    for (label, *_), (owner, name, function) in zip(timed_methods, original_methods, strict=True):
        setattr(owner, name, clock.wrap(label, function))
    try:
        yield
    finally:
        for owner, name, function in original_methods:
            setattr(owner, name, function)


def even_emd(job: Job, points: np.ndarray, settings: EvaluateParams) -> tuple[float, float]:
    """EMD under P1-even, and its floor."""
    truth_artifact = Truth.load(job.data / "truth" / job.part)
    part_frame = ReferenceSurface(load_mesh(job.data / "parts" / job.part))
    points = random_points(points.astype(float), settings.max_points, np.random.default_rng(0))
    truth = truth_artifact.points_mm.astype(float)
    kept = evaluated_mask(
        ReferenceRig(part_frame, settings),
        points,
        truth,
        truth_artifact.visible,
        settings.occlusion_margin,
    )
    a, b = part_frame.normalize(truth[truth_artifact.visible]), part_frame.normalize(points[kept])
    value = emd(farthest_points(a, settings.points), farthest_points(b, settings.points)).value
    return value, truth_artifact.floors["emd P1-even"].value


def with_value(job: Job, parameter: str, value: int) -> Job:
    """`job` with `what` at `value`."""
    settings, levels = job.settings, job.settings.levels
    match parameter:
        case "grid_res":
            return replace(job, settings=replace(settings, grid_res=value))
        case "views":
            return replace(job, views=value)
        case "image_size":
            warm_up, *levels = [
                replace(x, image_px=max(16, x.image_px * value // 512))
                for x in (settings.warm_up, *levels)
            ]
            return replace(
                job, settings=replace(settings, warm_up=warm_up, levels=levels), image_px=value
            )
        case _:
            levels = [levels[0], *(replace(x, points=value) for x in levels[1:])]
            return replace(job, settings=replace(settings, levels=levels))


def with_steps_scaled(job: Job, factor: float) -> Job:
    """`job` with `factor` times the steps."""
    settings = job.settings
    levels = [replace(x, steps=math.ceil(factor * x.steps)) for x in settings.levels]
    warm_up = replace(settings.warm_up, steps=round(factor * settings.warm_up.steps))
    settings = replace(settings, warm_up=warm_up, levels=levels)
    if job.method == "industnerf_plus":
        polish = replace(settings.polish, steps=round(factor * settings.polish.steps))
        settings = replace(settings, polish=polish)
    return replace(job, settings=settings)


def cost_rows(parameter: str, job: Job, limit: int | None) -> Iterator[tuple[str, ...]]:
    """A row for each value of `what`."""
    if parameter == "points" and job.settings.refine == "subdivide":
        return  # there the grid decides how many
    for value in VALUES[parameter][:limit]:
        result = run_in_subprocess(with_value(job, parameter, value))
        yield str(value), f"{result.seconds:.1f}", f"{result.peak_mb:.0f}", str(len(result.points))


def budget_rows(job: Job, limit: int | None) -> Iterator[tuple[str, ...]]:
    settings, default_seconds = load_params().evaluate, run_in_subprocess(job).seconds
    for seconds in BUDGETS[:limit]:
        result = run_within_budget(job, seconds, seconds / default_seconds)
        value, floor = even_emd(job, result.points, settings)
        numbers = f"{result.steps}", f"{result.seconds:.1f}", f"{value:.5f}", f"{value / floor:.2f}"
        yield str(seconds), *numbers


def run_within_budget(job: Job, seconds: float, factor: float) -> JobResult:
    """`job` with about the steps that take `seconds`; the first steps cost more than the last."""
    for _ in range(MAX_TRIES):
        result = run_in_subprocess(with_steps_scaled(job, factor))
        if abs(result.seconds / seconds - 1) < BUDGET_TOLERANCE:
            break
        factor *= seconds / result.seconds
    return result


def share_rows(job: Job, limit: int | None) -> Iterator[tuple[str, ...]]:
    result = run_in_subprocess(job)
    for label, seconds in result.shares.most_common(limit):
        numbers = seconds, 1000 * seconds / result.steps, 100 * seconds / result.seconds
        yield label, *(f"{number:.1f}" for number in numbers)


TABLES = {
    what: (partial(cost_rows, what), (what, "s", "peak MB", "points out")) for what in VALUES
} | {
    "budget": (budget_rows, ("budget s", "steps", "s", "EMD", "/ floor")),
    "shares": (share_rows, ("what", "s", "ms a step", "%")),
}


def print_row(*cells: str) -> None:
    """A row at once: the next may take minutes."""
    print(f"| {' | '.join(cells)} |", flush=True)


def main(argv: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("data", type=Path)
    parser.add_argument("--methods", nargs="+", choices=METHODS, default=METHODS)
    parser.add_argument("--parts", nargs="+", default=PARTS)
    parser.add_argument("--tables", nargs="+", choices=TABLES, default=list(TABLES))
    parser.add_argument("--first", type=int, help="only so many rows of each table and part")
    arguments, method_settings = parser.parse_args(argv), load_params().method
    for rows, heads in (TABLES[name] for name in arguments.tables):
        print_row("method", "part", *heads)
        print_row(*["---"] * (2 + len(heads)))
        for method, part in product(arguments.methods, arguments.parts):
            job = Job(arguments.data, part, method, getattr(method_settings, method))
            for row in rows(job, arguments.first):
                print_row(method, part, *row)
        print()


if __name__ == "__main__":
    main()
