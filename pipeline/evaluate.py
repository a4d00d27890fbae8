"""Score every cloud against its part; a failure has a score too.  DVC stage `evaluate`."""

from collections.abc import Iterable
from functools import partial
from pathlib import Path

from industnerf.artifacts.cloud import files_of_cloud
from industnerf.artifacts.scores import gather_scores
from industnerf.cli import run_as_stage
from industnerf.config import Masked
from industnerf.metrics.beyond import files_beyond
from industnerf.metrics.protocol import score_failure, score_part
from industnerf.stage import Task, read_failures, read_index, run_stage, write_failures


def main(
    cfg: Masked, method: str, parts: str, views: str, truth: str, clouds: str, out: str
) -> None:
    folders, part_ids = tuple(map(Path, (parts, truth, views, clouds))), read_index(Path(truth))
    failed = set(read_failures(Path(clouds)))
    tasks = tasks_of(cfg, folders, part_ids, failed)
    run_stage("evaluate", tasks, Path(out), cfg.on_failure, needs_one=False)
    unscored = read_failures(Path(out))
    if unscored:  # without a score a part would be missing from this method's means, and no other's
        tasks = tasks_of(cfg, folders, part_ids, failed | set(unscored))
        run_stage("evaluate", tasks, Path(out), "strict")
        write_failures(Path(out), unscored)
    gather_scores(Path(out), method)


def tasks_of(
    cfg: Masked, folders: tuple[Path, ...], part_ids: Iterable[str], failed: set[str]
) -> list[Task]:
    """`folders` are those of parts, truth, views and clouds."""
    tasks = []
    for part_id in part_ids:
        part, known, taken, cloud = (folder / part_id for folder in folders)
        inputs = (part / "mesh.npz", known)
        make = partial(score_failure, part, known, settings=cfg.evaluate, seed=cfg.seed)
        if part_id not in failed:
            inputs = (*inputs, *files_of_cloud(cloud), *files_beyond(taken, cloud))
            shown = (part, known, taken, cloud)
            make = partial(score_part, *shown, settings=cfg.evaluate, seed=cfg.seed)
        tasks.append(Task(part_id, make, [cfg.evaluate, cfg.seed, part_id in failed], inputs))
    return tasks


if __name__ == "__main__":
    run_as_stage(main, "evaluate")
