"""Reconstruct every part from the inputs that the method declares.  DVC stage `reconstruct`."""

from functools import partial
from pathlib import Path

from industnerf.cli import run_as_stage
from industnerf.config import Masked
from industnerf.methods import load_method
from industnerf.methods.apply import files_of, reconstruct_part
from industnerf.stage import Task, read_failures, read_index, run_stage


def main(cfg: Masked, name: str, parts: str, views: str, out: str) -> None:
    method, settings = load_method(name), getattr(cfg.method, name)
    tasks = []
    for part_id in read_index(Path(views)):
        part, taken = Path(parts) / part_id, Path(views) / part_id
        make = partial(reconstruct_part, method, part, taken, settings=settings, seed=cfg.seed)
        inputs = files_of(method, part, taken)
        tasks.append(Task(part_id, make, [name, settings, cfg.seed], inputs, (method.module,)))
    run_stage(
        "reconstruct",
        tasks,
        Path(out),
        cfg.on_failure,
        failed_before=read_failures(Path(views)),
        limit_s=cfg.reconstruct.time_limit_s,
    )


if __name__ == "__main__":
    run_as_stage(main, "reconstruct")
