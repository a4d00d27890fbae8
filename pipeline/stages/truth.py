"""Sample the true surface, mark what the reference rig sees, measure the floors.  Stage `truth`."""

from functools import partial
from pathlib import Path

from industnerf.cli import run_as_stage
from industnerf.config import StageParams
from industnerf.metrics.truth import measure_truth
from industnerf.stage import Task, read_failures, read_index, run_stage


def main(cfg: StageParams, parts: str, out: str) -> None:
    tasks = [
        Task(
            part_id,
            partial(measure_truth, Path(parts) / part_id, settings=cfg.evaluate, seed=cfg.seed),
            [cfg.evaluate, cfg.seed, part_id],  # the samples are drawn by its name
            (Path(parts) / part_id / "mesh.npz",),
        )
        for part_id in read_index(Path(parts))
    ]
    earlier_failures = read_failures(Path(parts))
    run_stage("truth", tasks, Path(out), cfg.on_failure, earlier_failures=earlier_failures)


if __name__ == "__main__":
    run_as_stage(main, "truth")
