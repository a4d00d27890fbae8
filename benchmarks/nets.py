"""How much do the networks gain from more training?

OMP_NUM_THREADS=1 python benchmarks/nets.py DATA [--methods ...] [--times 1 4 15] [--fold 0]
    [--experiment gpu]

DATA is the folder `data` of a finished run, of which `parts`, `views`, `truth` and `split.json`
are read.  Each network is trained on the parts of the other folds, with so many times the steps
of params.yaml, or of a preset, and then reconstructs the parts of the fold.  Other than 1 time it
does not end early, and validates at least twenty times.  `minutes` are those of one processor, on
a GPU by the clock, reading and targets included.  EMD is P1-even, the mean over reported parts and
over dev parts; retrieval and the mean shape stand beside it.  `best step` is the step of the last
phase whose weights were best on validation.  `memory` is torch's on the GPU.  Rows run one after
the other, each in a process of its own.
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
from industnerf.artifacts.part import load_parts
from industnerf.artifacts.split import load_split, train_parts
from industnerf.artifacts.state import ModelState
from industnerf.artifacts.truth import Truth
from industnerf.config import build, load_params
from industnerf.device import device
from industnerf.errors import ReconstructionFailed
from industnerf.methods import load_method
from industnerf.methods.base import Example, load_inputs
from industnerf.metrics.protocol import Evaluator
from industnerf.report.tables.formats import markdown_table
from industnerf.schema import Params

NETS = ["r2n2", "atlasnet", "occupancy"]
BASELINES = ["retrieval", "mean_shape"]
COLUMNS = (
    *("method", "numbers", "minutes", "steps", "converged", "best step", "val loss, best", "last"),
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
class JobResult:
    job: Job
    seconds: float
    state: ModelState
    test: float
    dev: float
    memory_gb: float  # most that torch had on the GPU; 0 without one


def run(job: Job) -> JobResult:
    method = load_method(job.method)
    assignments, net = load_split(job.data / "split.json"), f"fold-{job.fold}"
    families = {part.part_id: part.family for part in load_parts(job.data / "parts")}
    examples = [
        Example(
            part,
            families[part],
            job.data / "parts" / part,
            job.data / "views" / part,
            method.inputs,
        )
        for part in train_parts(assignments, net)
    ]
    clock = process_time if device().type == "cpu" else perf_counter
    start = clock()
    with TemporaryDirectory() as scratch:
        state = method.fit(examples, job.settings, 0, Path(scratch))
    seconds = clock() - start
    memory_gb = torch.cuda.max_memory_allocated() / 1e9 if torch.cuda.is_available() else 0.0
    fold_assignments = {
        part: assignment for part, assignment in assignments.items() if assignment.net_name == net
    }
    emds = {part: mean_emd(job, state, part) for part in fold_assignments}
    test, dev = (
        [emds[p] for p in fold_assignments if fold_assignments[p].split == split]
        for split in ("test", "dev")
    )
    return JobResult(job, seconds, state, fmean(test), fmean(dev), memory_gb)


def load_experiment_params(experiment: str | None) -> Params:
    """Those of params.yaml, or what the preset makes of them."""
    if experiment is None:
        return load_params()
    os.environ["INDUSTNERF_ROOT"] = os.getcwd()  # where conf/config.yaml looks for params.yaml
    with initialize_config_dir(os.path.abspath("conf"), version_base="1.3"):
        composed = compose("config", [f"experiment={experiment}"])
    return build(Params, OmegaConf.to_container(composed), experiment)


def with_steps_scaled(settings: Any, times: float) -> Any:
    """`settings` with so many times the steps."""
    if times == 1:
        return settings
    steps = round(times * settings.training.max_steps)
    interval = min(settings.training.val_interval, max(1, steps // 20))
    scaled = {"max_steps": steps, "patience": steps, "val_interval": interval}
    return replace(settings, training=replace(settings.training, **scaled))


def mean_emd(job: Job, state: ModelState, part: str) -> float:
    """P1-even by params.yaml, the mean over all predictions; a failure scores as one."""
    folder, truth = job.data / "parts" / part, Truth.load(job.data / "truth" / part)
    evaluator, method = Evaluator(folder, truth, load_params().evaluate, 0), load_method(job.method)
    try:
        inputs = load_inputs(method, folder, job.data / "views" / part)
        prediction = method.reconstruct(inputs, job.settings, state, 0)
        clouds = [prediction.points_mm, *prediction.extra_clouds_mm]
    except ReconstructionFailed:
        clouds = []
    values = [
        evaluator.evaluate(cloud, all_metrics=False) or evaluator.failure_scores(all_metrics=False)
        for cloud in clouds
    ]
    return fmean(
        scores[0].value for scores in values or [evaluator.failure_scores(all_metrics=False)]
    )


def row_cells(result: JobResult) -> list[str]:
    """Of COLUMNS."""
    state = result.state
    return [
        result.job.method,
        str(state.num_parameters),
        f"{result.seconds / 60:.1f}",
        str(state.steps),
        "yes" if state.converged else "no",
        *validation_cells(state.val_history),
        f"{result.memory_gb:.1f}",
        f"{result.test:.4f}",
        f"{result.dev:.4f}",
    ]


def validation_cells(curve: History | None) -> list[str]:
    """Of the last phase: the step of the least loss, that loss, and the last one; none without."""
    if curve is None or not len(curve.loss):
        return ["", "", ""]
    in_last_phase = curve.steps >= max(curve.levels.values(), default=0)
    steps, loss = curve.steps[in_last_phase], curve.loss[in_last_phase]
    return [str(steps[loss.argmin()]), f"{loss.min():.4g}", f"{loss[-1]:.4g}"]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("data", type=Path)
    parser.add_argument("--methods", nargs="+", default=NETS)
    parser.add_argument("--times", nargs="+", type=float, default=[1, 4, 15])
    parser.add_argument("--fold", type=int, default=0)
    parser.add_argument("--experiment")
    arguments = parser.parse_args()
    method_settings = load_experiment_params(arguments.experiment).method
    jobs = [
        Job(
            arguments.data,
            name,
            arguments.fold,
            times,
            with_steps_scaled(getattr(method_settings, name), times),
        )
        for name, times in [*product(BASELINES, [1]), *product(arguments.methods, arguments.times)]
    ]
    print(markdown_table(COLUMNS, []), end="")
    for job in jobs:
        with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
            result = pool.submit(run, job).result()
        print("| " + " | ".join(row_cells(result)) + " |", flush=True)


if __name__ == "__main__":
    main()
