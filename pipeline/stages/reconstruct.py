"""Reconstruct every part from the inputs that the method declares.  DVC stage `reconstruct`."""

from functools import partial
from pathlib import Path

from industnerf.artifacts.split import load_split
from industnerf.cli import run_as_stage
from industnerf.config import StageParams
from industnerf.methods import load_method
from industnerf.methods.base import Scope
from industnerf.methods.run_method import input_files, reconstruct_part
from industnerf.stage import Task, read_failures, read_index, run_stage


def main(
    cfg: StageParams, name: str, parts: str, views: str, split: str, states: str, out: str
) -> None:
    method, settings = load_method(name), getattr(cfg.method, name)
    learns = method.scope == Scope.DATASET
    untrained = read_failures(Path(states) / name) if learns else {}
    assignments, failed, tasks = load_split(Path(split)), read_failures(Path(views)), []
    for part_id in read_index(Path(views)):
        part_dir = Path(parts) / part_id
        views_dir = Path(views) / part_id
        fold = assignments[part_id].net_name
        state = Path(states) / name / fold if learns else None
        if fold in untrained:
            failed[part_id] = f"its net, {fold}, was not trained: {untrained[fold]}"
            continue
        num_views = cfg.reconstruct.views
        keywords = {"settings": settings, "seed": cfg.seed, "num_views": num_views}
        make = partial(reconstruct_part, method, part_dir, views_dir, state, **keywords)
        inputs = (
            *input_files(method, part_dir, views_dir),
            *([state / "state.npz"] if state else []),
        )
        key = [name, settings, cfg.seed, num_views]
        tasks.append(Task(part_id, make, key, inputs, (method.module,)))
    limits = {"limit_s": cfg.reconstruct.time_limit_s, "needs_one": False}
    run_stage("reconstruct", tasks, Path(out), cfg.on_failure, earlier_failures=failed, **limits)


if __name__ == "__main__":
    run_as_stage(main, "reconstruct")
