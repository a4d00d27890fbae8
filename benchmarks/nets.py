"""What does more training buy the nets?

OMP_NUM_THREADS=1 python benchmarks/nets.py DATA [--methods ...] [--minutes ...] [--fold 0]

DATA is the folder `data` of a finished run, of which `parts`, `views`, `truth` and `split.json`
are read.  Each net learns from the parts of the other folds with as many steps as take about so
many minutes of one processor, and is then asked about the parts of the fold.  EMD is P1-even, the
mean over the fold's reported parts and over its dev parts; retrieval and the mean shape stand
beside it.  Rows run one after the other, each in a process of its own.
"""

import argparse
import multiprocessing
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path
from statistics import fmean
from tempfile import TemporaryDirectory
from time import process_time
from typing import Any

from industnerf.artifacts.split import load_split, taught
from industnerf.artifacts.state import State
from industnerf.artifacts.truth import Truth
from industnerf.config import load_params
from industnerf.errors import ReconstructionFailed
from industnerf.methods import load_method
from industnerf.methods.base import Example, hand_over
from industnerf.metrics.protocol import Judge

NETS = ["r2n2", "atlasnet", "occupancy"]
SIMPLE = ["retrieval", "mean_shape"]
PROBE = 20  # steps that tell how long one takes


@dataclass(frozen=True)
class Job:
    data: Path
    method: str
    fold: int
    minutes: float | None  # None: as params.yaml has it


@dataclass(frozen=True)
class Done:
    job: Job
    seconds: float
    state: State
    test: float
    dev: float


def learn(job: Job, settings: Any) -> tuple[State, float]:
    """What the method learns, and the processor seconds that it took."""
    method, net = load_method(job.method), f"fold-{job.fold}"
    examples = [
        Example(part, job.data / "parts" / part, job.data / "views" / part, method.inputs)
        for part in taught(load_split(job.data / "split.json"), net)
    ]
    start = process_time()
    with TemporaryDirectory() as scratch:
        return method.fit(examples, settings, 0, Path(scratch)), process_time() - start


def scaled_to(job: Job, settings: Any) -> Any:
    """`settings` with as many steps as take `job.minutes`, and no early end."""

    def with_steps(steps: int) -> Any:
        return replace(settings, training=replace(settings.training, steps=steps, patience=steps))

    few, short = learn(job, with_steps(PROBE))
    more, longer = learn(job, with_steps(3 * PROBE))
    a_step = (longer - short) / (more.steps - few.steps)
    return with_steps(max(PROBE, round((60 * job.minutes - short) / a_step)))


def run(job: Job) -> Done:
    settings = getattr(load_params().method, job.method)
    if job.minutes is not None:
        settings = scaled_to(job, settings)
    state, seconds = learn(job, settings)
    places = load_split(job.data / "split.json")
    asked = {part: place for part, place in places.items() if place.fold == job.fold}
    emds = {part: emd(job, settings, state, part) for part in asked}
    test, dev = ([emds[p] for p in asked if asked[p].split == split] for split in ("test", "dev"))
    return Done(job, seconds, state, fmean(test), fmean(dev))


def emd(job: Job, settings: Any, state: State, part: str) -> float:
    """P1-even of one part, the mean over all answers; a failure scores as one."""
    folder, known = job.data / "parts" / part, Truth.load(job.data / "truth" / part)
    judge, method = Judge(folder, known, load_params().evaluate, 0), load_method(job.method)
    try:
        given = hand_over(method, folder, job.data / "views" / part)
        answer = method.reconstruct(given, settings, state, 0)
        clouds = [answer.points_mm, *answer.others_mm]
    except ReconstructionFailed:
        clouds = []
    values = [judge.judged(cloud, every=False) or judge.nothing(every=False) for cloud in clouds]
    return fmean(found[0].value for found in values or [judge.nothing(every=False)])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("data", type=Path)
    parser.add_argument("--methods", nargs="+", default=NETS)
    parser.add_argument("--minutes", nargs="+", type=float, default=[4, 15, 60])
    parser.add_argument("--fold", type=int, default=0)
    asked = parser.parse_args()
    jobs = [Job(asked.data, name, asked.fold, None) for name in SIMPLE]
    jobs += [Job(asked.data, n, asked.fold, m) for n in asked.methods for m in asked.minutes]
    print(
        "| method | minutes | steps | settled | EMD (test) | EMD (dev) |\n|---|---|---|---|---|---|"
    )
    for job in jobs:
        with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
            done = pool.submit(run, job).result()
        print(
            f"| {job.method} | {done.seconds / 60:.1f} | {done.state.steps} "
            f"| {'yes' if done.state.settled else 'no'} | {done.test:.4f} | {done.dev:.4f} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
