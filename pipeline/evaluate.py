"""Score every cloud against its part; a failure has a score too.  DVC stage `evaluate`."""

from functools import partial
from pathlib import Path

from industnerf.artifacts.cloud import files_of_cloud
from industnerf.artifacts.scores import gather_scores
from industnerf.cli import run_as_stage
from industnerf.config import Masked
from industnerf.metrics.beyond import files_beyond
from industnerf.metrics.protocol import score_failure, score_part
from industnerf.stage import Task, read_failures, read_index, run_stage


def main(
    cfg: Masked, method: str, parts: str, views: str, truth: str, clouds: str, out: str
) -> None:
    failed, tasks = read_failures(Path(clouds)), []
    for part_id in read_index(Path(truth)):
        part, known, taken, cloud = (Path(p) / part_id for p in (parts, truth, views, clouds))
        inputs = (part / "mesh.npz", known)
        make = partial(score_failure, part, known, settings=cfg.evaluate, seed=cfg.seed)
        if part_id not in failed:
            inputs = (*inputs, *files_of_cloud(cloud), *files_beyond(taken, cloud))
            shown = (part, known, taken, cloud)
            make = partial(score_part, *shown, settings=cfg.evaluate, seed=cfg.seed)
        tasks.append(Task(part_id, make, [cfg.evaluate, cfg.seed, part_id in failed], inputs))
    run_stage("evaluate", tasks, Path(out), cfg.on_failure)
    gather_scores(Path(out), method)


if __name__ == "__main__":
    run_as_stage(main, "evaluate")
