"""Let a method learn from other parts, once a fold.  DVC stage `train`."""

from functools import partial
from pathlib import Path

from industnerf.artifacts.split import load_split, taught
from industnerf.cli import run_as_stage
from industnerf.config import Masked
from industnerf.methods import load_method
from industnerf.methods.apply import files_to_learn_from, learn
from industnerf.methods.base import Example, Scope
from industnerf.stage import Task, read_index, run_stage


def main(cfg: Masked, name: str, parts: str, views: str, split: str, out: str) -> None:
    method, settings = load_method(name), getattr(cfg.method, name)
    places, photographed = load_split(Path(split)), read_index(Path(views))
    asked = {places[part_id].net for part_id in photographed}
    tasks = []
    for net in sorted(asked) if method.scope == Scope.DATASET else []:
        examples = [
            Example(part_id, Path(parts) / part_id, Path(views) / part_id, method.inputs)
            for part_id in taught(places, net)
            if part_id in photographed
        ]
        make = partial(learn, method, examples, settings=settings, seed=cfg.seed)
        inputs = tuple(path for example in examples for path in files_to_learn_from(example))
        key = [name, settings, cfg.seed]
        tasks.append(Task(net, make, key, inputs, (method.module,), resumable=True))
    limits = {"limit_s": cfg.train.time_limit_s, "needs_one": False}
    run_stage("train", tasks, Path(out), cfg.on_failure, **limits)


if __name__ == "__main__":
    run_as_stage(main, "train")
