"""Reconstruct every part from the inputs that the method declares.  DVC stage `reconstruct`."""

from functools import partial
from pathlib import Path

from industnerf.artifacts.split import load_split
from industnerf.cli import run_as_stage
from industnerf.config import Masked
from industnerf.methods import load_method
from industnerf.methods.apply import files_of, reconstruct_part
from industnerf.methods.base import Scope
from industnerf.stage import Task, read_failures, read_index, run_stage


def main(cfg: Masked, name: str, parts: str, views: str, split: str, states: str, out: str) -> None:
    method, settings = load_method(name), getattr(cfg.method, name)
    places, unlearned = load_split(Path(split)), read_failures(Path(states))
    failed, tasks = read_failures(Path(views)), []
    for part_id in read_index(Path(views)):
        part, taken, net = Path(parts) / part_id, Path(views) / part_id, places[part_id].net
        state = Path(states) / net if method.scope == Scope.DATASET else None
        if state is not None and net in unlearned:
            failed[part_id] = f"its net, {net}, was not trained: {unlearned[net]}"
            continue
        count = cfg.reconstruct.views
        how = {"settings": settings, "seed": cfg.seed, "count": count}
        make = partial(reconstruct_part, method, part, taken, state, **how)
        inputs = (*files_of(method, part, taken), *([state / "state.npz"] if state else []))
        key = [name, settings, cfg.seed, count]
        tasks.append(Task(part_id, make, key, inputs, (method.module,)))
    limits = {"limit_s": cfg.reconstruct.time_limit_s, "needs_one": False}
    run_stage("reconstruct", tasks, Path(out), cfg.on_failure, failed_before=failed, **limits)


if __name__ == "__main__":
    run_as_stage(main, "reconstruct")
