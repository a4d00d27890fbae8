"""What does more training buy the nets?

OMP_NUM_THREADS=1 python benchmarks/nets.py DATA [--methods ...] [--times 1 4 15] [--fold 0]

DATA is the folder `data` of a finished run, of which `parts`, `views`, `truth` and `split.json`
are read.  Each net learns from the parts of the other folds, with so many times the steps of
params.yaml, and is then asked about the parts of the fold.  More than 1 time it does not end early.
`minutes` are those of one processor, reading and targets included.  EMD is P1-even, the mean over
reported parts and over dev parts; retrieval and the mean shape stand beside it.  Rows run one after
the other, each in a process of its own.
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


@dataclass(frozen=True)
class Job:
    data: Path
    method: str
    fold: int
    times: float


@dataclass(frozen=True)
class Done:
    job: Job
    seconds: float
    state: State
    test: float
    dev: float


def run(job: Job) -> Done:
    settings, method = settings_of(job), load_method(job.method)
    places, net = load_split(job.data / "split.json"), f"fold-{job.fold}"
    examples = [
        Example(part, job.data / "parts" / part, job.data / "views" / part, method.inputs)
        for part in taught(places, net)
    ]
    start = process_time()
    with TemporaryDirectory() as scratch:
        state = method.fit(examples, settings, 0, Path(scratch))
    seconds = process_time() - start
    asked = {part: place for part, place in places.items() if place.net == net}
    emds = {part: emd(job, settings, state, part) for part in asked}
    test, dev = ([emds[p] for p in asked if asked[p].split == split] for split in ("test", "dev"))
    return Done(job, seconds, state, fmean(test), fmean(dev))


def settings_of(job: Job) -> Any:
    """Those of params.yaml, with so many times the steps."""
    settings = getattr(load_params().method, job.method)
    if job.times == 1:
        return settings
    steps = round(job.times * settings.training.steps)
    return replace(settings, training=replace(settings.training, steps=steps, patience=steps))


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
    parser.add_argument("--times", nargs="+", type=float, default=[1, 4, 15])
    parser.add_argument("--fold", type=int, default=0)
    asked = parser.parse_args()
    jobs = [Job(asked.data, name, asked.fold, 1) for name in SIMPLE]
    jobs += [Job(asked.data, n, asked.fold, m) for n in asked.methods for m in asked.times]
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
