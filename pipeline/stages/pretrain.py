"""The weights that each network starts from: shipped, or pretrained.  DVC stage `pretrain`."""

from dataclasses import replace
from functools import partial
from pathlib import Path

from industnerf.cli import run_as_stage
from industnerf.config import StageParams
from industnerf.errors import BadParams
from industnerf.methods import load_method
from industnerf.methods.run_method import WEIGHTS, copy_weights, pretrain_method
from industnerf.stage import Batch, Task, read_index, run_methods

NETWORKS = ("r2n2", "atlasnet", "occupancy")


def main(cfg: StageParams, shipped: str, procedural: str, out: str) -> None:
    networks = [name for name in cfg.methods if name in NETWORKS]
    batches = {
        name: Batch(
            weights_tasks(cfg, name, Path(shipped) / name, Path(procedural)), Path(out) / name
        )
        for name in networks
    }
    run_methods("pretrain", batches, Path(out), "strict", limit_s=cfg.pretrain.time_limit_s)


def weights_tasks(cfg: StageParams, name: str, source: Path, procedural: Path) -> list[Task]:
    """What brings the weights that the network `name` starts from: none, or one task."""
    if cfg.pretrain.weights == "shipped":
        if not source.is_dir():
            raise BadParams(
                f"no weights of {name} ship in {source}: set pretrain.weights to trained, "
                "or to none"
            )
        files = tuple(sorted(path for path in source.rglob("*") if path.is_file()))
        return [Task(WEIGHTS, partial(copy_weights, source), name, files)]
    if cfg.pretrain.weights != "trained":
        return []
    method, settings, chunks = load_method(name), getattr(cfg.method, name), read_index(procedural)
    settings = replace(settings, training=settings.pretraining)
    make = partial(pretrain_method, method, procedural, [*chunks], settings=settings, seed=cfg.seed)
    key = [name, settings, cfg.seed, [*chunks.values()]]  # which stand for all files of theirs
    return [Task(WEIGHTS, make, key, (), (method.module,), resumable=True)]


if __name__ == "__main__":
    run_as_stage(main, "pretrain")
