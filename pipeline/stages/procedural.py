"""Make procedural solids for networks to learn from.  DVC stage `procedural`."""

from functools import partial
from pathlib import Path

from industnerf.cli import run_as_stage
from industnerf.config import StageParams
from industnerf.methods import load_method
from industnerf.methods.base import Input
from industnerf.procedural_dataset import chunk_ranges, make_chunk
from industnerf.stage import Task, run_stage


def main(cfg: StageParams, out: str) -> None:
    """Make the solids, if one of the methods learns from them."""
    settings, tasks = cfg.procedural, []
    is_read = any(Input.PROCEDURAL_SOLIDS in load_method(name).inputs for name in cfg.methods)
    for name, indices in chunk_ranges(settings.solids if is_read else 0).items():
        make = partial(
            make_chunk, indices=indices, seed=cfg.seed, settings=settings, views=cfg.views
        )
        how = [settings.kinds, settings.views, settings.image_px]
        tasks.append(Task(name, make, [cfg.seed, list(indices), how, cfg.views], ()))
    run_stage("procedural", tasks, Path(out), "strict", needs_one=False)


if __name__ == "__main__":
    run_as_stage(main, "procedural")
