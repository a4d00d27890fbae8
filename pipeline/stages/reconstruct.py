"""Reconstruct every part from the inputs that the method declares.  DVC stage `reconstruct`."""

from functools import partial
from pathlib import Path

from industnerf.artifacts.split import load_split
from industnerf.cli import run_as_stage
from industnerf.config import StageParams
from industnerf.methods import load_method
from industnerf.methods.base import Method, Scope
from industnerf.methods.run_method import input_files, reconstruct_part
from industnerf.stage import Batch, Task, read_failures, read_index, run_methods


def main(cfg: StageParams, parts: str, views: str, split: str, states: str, out: str) -> None:
    folders = tuple(map(Path, (parts, views, split, states)))
    batches = {
        name: reconstruction_batch(cfg, load_method(name), *folders, Path(out) / name)
        for name in cfg.methods
    }
    limit_s = cfg.reconstruct.time_limit_s
    run_methods("reconstruct", batches, Path(out), cfg.on_failure, limit_s=limit_s)


def reconstruction_batch(
    cfg: StageParams, method: Method, parts: Path, views: Path, split: Path, states: Path, out: Path
) -> Batch:
    """One task a part; and the parts that failed before, with the reason."""
    settings, num_views = getattr(cfg.method, method.name), cfg.reconstruct.views
    learns = method.scope == Scope.DATASET
    untrained = read_failures(states / method.name) if learns else {}
    assignments, failed, tasks = load_split(split), read_failures(views), []
    for part_id in read_index(views):
        part_dir, views_dir = parts / part_id, views / part_id
        fold = assignments[part_id].net_name
        state = states / method.name / fold if learns else None
        if fold in untrained:
            failed[part_id] = f"its net, {fold}, was not trained: {untrained[fold]}"
            continue
        keywords = {"settings": settings, "seed": cfg.seed, "num_views": num_views}
        make = partial(reconstruct_part, method, part_dir, views_dir, state, **keywords)
        inputs = (
            *input_files(method, part_dir, views_dir),
            *([state / "state.npz"] if state else []),
        )
        key = [method.name, settings, cfg.seed, num_views]
        tasks.append(Task(part_id, make, key, inputs, (method.module,)))
    return Batch(tasks, out, failed)


if __name__ == "__main__":
    run_as_stage(main, "reconstruct")
