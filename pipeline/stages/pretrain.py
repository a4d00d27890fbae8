"""The weights that a network starts from: shipped, or pretrained.  DVC stage `pretrain`."""

from dataclasses import replace
from functools import partial
from pathlib import Path

from industnerf.cli import run_as_stage
from industnerf.config import StageParams
from industnerf.errors import BadParams
from industnerf.methods import load_method
from industnerf.methods.run_method import WEIGHTS, copy_weights, pretrain_method
from industnerf.stage import Task, read_index, run_stage


def main(cfg: StageParams, name: str, shipped: str, procedural: str, out: str) -> None:
    method, settings, source = load_method(name), getattr(cfg.method, name), Path(shipped) / name
    tasks = []
    if name in cfg.methods and cfg.pretrain.weights == "shipped":
        if not source.is_dir():
            raise BadParams(
                f"no weights of {name} ship in {source}: set pretrain.weights to trained, "
                "or to none"
            )
        files = tuple(sorted(path for path in source.rglob("*") if path.is_file()))
        tasks = [Task(WEIGHTS, partial(copy_weights, source), name, files)]
    elif name in cfg.methods and cfg.pretrain.weights == "trained":
        chunks = read_index(Path(procedural))
        settings = replace(settings, training=settings.pretraining)
        make = partial(
            pretrain_method, method, Path(procedural), [*chunks], settings=settings, seed=cfg.seed
        )
        key = [name, settings, cfg.seed, [*chunks.values()]]  # which stand for all files of theirs
        tasks = [Task(WEIGHTS, make, key, (), (method.module,), resumable=True)]
    run_stage(
        "pretrain", tasks, Path(out), "strict", limit_s=cfg.pretrain.time_limit_s, needs_one=False
    )


if __name__ == "__main__":
    run_as_stage(main, "pretrain")
