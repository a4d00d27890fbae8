"""Photograph every part from every camera.  DVC stage `views`."""

from functools import partial
from pathlib import Path

from industnerf.artifacts.part_warnings import print_part_warnings
from industnerf.capture.render import render_part
from industnerf.capture.rng import is_random
from industnerf.cli import run_as_stage
from industnerf.config import StageParams
from industnerf.stage import Task, read_failures, read_index, run_stage


def main(cfg: StageParams, parts: str, out: str) -> None:
    # Without a random setting another seed gives the same photographs, and finds them in the store.
    settings = [cfg.views, cfg.seed] if is_random(cfg.views) else cfg.views
    tasks = [
        Task(
            part_id,
            partial(render_part, Path(parts) / part_id, settings=cfg.views, seed=cfg.seed),
            settings,
            (Path(parts) / part_id / "part.json", Path(parts) / part_id / "mesh.npz"),
        )
        for part_id in read_index(Path(parts))
    ]
    earlier_failures = read_failures(Path(parts))
    run_stage("views", tasks, Path(out), cfg.on_failure, earlier_failures=earlier_failures)
    print_part_warnings(Path(out), "views")


if __name__ == "__main__":
    run_as_stage(main, "views")
