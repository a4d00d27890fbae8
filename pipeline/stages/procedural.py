"""Make procedural solids for networks to learn from.  DVC stage `procedural`."""

from functools import partial
from pathlib import Path

from industnerf.cli import run_as_stage
from industnerf.config import StageParams
from industnerf.procedural_dataset import chunk_ranges, make_chunk
from industnerf.stage import Task, run_stage


def main(cfg: StageParams, out: str) -> None:
    settings, tasks = cfg.procedural, []
    for name, indices in chunk_ranges(settings.solids).items():
        make = partial(
            make_chunk, indices=indices, seed=cfg.seed, settings=settings, views=cfg.views
        )
        how = [settings.kinds, settings.views, settings.image_px]
        tasks.append(Task(name, make, [cfg.seed, list(indices), how, cfg.views], ()))
    run_stage("procedural", tasks, Path(out), "strict", needs_one=False)


if __name__ == "__main__":
    run_as_stage(main, "procedural")
