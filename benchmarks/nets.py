"""What does more training buy the nets?

OMP_NUM_THREADS=1 python benchmarks/nets.py DATA [--methods ...] [--times 1 4 15] [--fold 0]
    [--experiment gpu]

DATA is the folder `data` of a finished run, of which `parts`, `views`, `truth` and `split.json`
are read.  Each net learns from the parts of the other folds, with so many times the steps of
params.yaml, or of a preset, and is then asked about the parts of the fold.  Other than 1 time it
does not end early, and validates at least twenty times.  `minutes` are those of one processor, on
a GPU by the clock, reading and targets included.  EMD is P1-even, the mean over reported parts and
over dev parts; retrieval and the mean shape stand beside it.  `kept`: the step whose weights were
best on validation, of the last phase.  `memory` is torch's on the GPU.  Rows run one after the
other, each in a process of its own.
"""

import argparse
import multiprocessing
import os
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path
from statistics import fmean
from tempfile import TemporaryDirectory
from time import perf_counter, process_time
from typing import Any

import torch
from hydra import compose, initialize_config_dir
from omegaconf import OmegaConf

from industnerf.artifacts.history import History
from industnerf.artifacts.split import load_split, taught
from industnerf.artifacts.state import State
from industnerf.artifacts.truth import Truth
from industnerf.config import build, load_params
from industnerf.device import device
from industnerf.errors import ReconstructionFailed
from industnerf.methods import load_method
from industnerf.methods.base import Example, hand_over
from industnerf.metrics.protocol import Judge
from industnerf.report.formats import markdown
from industnerf.schema import Params

NETS = ["r2n2", "atlasnet", "occupancy"]
SIMPLE = ["retrieval", "mean_shape"]
COLUMNS = (
    *("method", "numbers", "minutes", "steps", "settled", "kept", "validation, best", "last"),
    *("memory, GB", "EMD (test)", "EMD (dev)"),
)


@dataclass(frozen=True)
class Job:
    data: Path
    method: str
    fold: int
    times: float
    settings: Any


@dataclass(frozen=True)
class Done:
    job: Job
    seconds: float
    state: State
    test: float
    dev: float
    memory_gb: float  # most that torch had on the GPU; 0 without one


def run(job: Job) -> Done:
    method = load_method(job.method)
    places, net = load_split(job.data / "split.json"), f"fold-{job.fold}"
    examples = [
        Example(part, job.data / "parts" / part, job.data / "views" / part, method.inputs)
        for part in taught(places, net)
    ]
    clock = process_time if device().type == "cpu" else perf_counter
    start = clock()
    with TemporaryDirectory() as scratch:
        state = method.fit(examples, job.settings, 0, Path(scratch))
    seconds = clock() - start
    memory_gb = torch.cuda.max_memory_allocated() / 1e9 if torch.cuda.is_available() else 0.0
    asked = {part: place for part, place in places.items() if place.net == net}
    emds = {part: emd(job, state, part) for part in asked}
    test, dev = ([emds[p] for p in asked if asked[p].split == split] for split in ("test", "dev"))
    return Done(job, seconds, state, fmean(test), fmean(dev), memory_gb)


def params_of(experiment: str | None) -> Params:
    """Those of params.yaml, or what the preset makes of them."""
    if experiment is None:
        return load_params()
    os.environ["INDUSTNERF_ROOT"] = os.getcwd()  # where conf/config.yaml looks for params.yaml
    with initialize_config_dir(os.path.abspath("conf"), version_base="1.3"):
        found = compose("config", [f"experiment={experiment}"])
    return build(Params, OmegaConf.to_container(found), experiment)


def stretched(settings: Any, times: float) -> Any:
    """`settings` with so many times the steps."""
    if times == 1:
        return settings
    steps = round(times * settings.training.steps)
    every = min(settings.training.validate_every, max(1, steps // 20))
    ways = replace(settings.training, steps=steps, patience=steps, validate_every=every)
    return replace(settings, training=ways)


def emd(job: Job, state: State, part: str) -> float:
    """P1-even by params.yaml, the mean over all answers; a failure scores as one."""
    folder, known = job.data / "parts" / part, Truth.load(job.data / "truth" / part)
    judge, method = Judge(folder, known, load_params().evaluate, 0), load_method(job.method)
    try:
        given = hand_over(method, folder, job.data / "views" / part)
        answer = method.reconstruct(given, job.settings, state, 0)
        clouds = [answer.points_mm, *answer.others_mm]
    except ReconstructionFailed:
        clouds = []
    values = [judge.judged(cloud, every=False) or judge.nothing(every=False) for cloud in clouds]
    return fmean(found[0].value for found in values or [judge.nothing(every=False)])


def cells(done: Done) -> list[str]:
    """Of COLUMNS."""
    state = done.state
    return [
        done.job.method,
        str(state.parameters),
        f"{done.seconds / 60:.1f}",
        str(state.steps),
        "yes" if state.settled else "no",
        *validated(state.validation),
        f"{done.memory_gb:.1f}",
        f"{done.test:.4f}",
        f"{done.dev:.4f}",
    ]


def validated(curve: History | None) -> list[str]:
    """Of the last phase: the step of the least loss, that loss, and the last one; none without."""
    if curve is None or not len(curve.loss):
        return ["", "", ""]
    last = curve.steps >= max(curve.levels.values(), default=0)
    steps, loss = curve.steps[last], curve.loss[last]
    return [str(steps[loss.argmin()]), f"{loss.min():.4g}", f"{loss[-1]:.4g}"]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("data", type=Path)
    parser.add_argument("--methods", nargs="+", default=NETS)
    parser.add_argument("--times", nargs="+", type=float, default=[1, 4, 15])
    parser.add_argument("--fold", type=int, default=0)
    parser.add_argument("--experiment")
    asked = parser.parse_args()
    known = params_of(asked.experiment).method
    jobs = [
        Job(asked.data, name, asked.fold, times, stretched(getattr(known, name), times))
        for name, times in [*product(SIMPLE, [1]), *product(asked.methods, asked.times)]
    ]
    print(markdown(COLUMNS, []), end="")
    for job in jobs:
        with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
            done = pool.submit(run, job).result()
        print("| " + " | ".join(cells(done)) + " |", flush=True)


if __name__ == "__main__":
    main()
