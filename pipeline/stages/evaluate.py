"""Score every cloud against its part; a failure has a score too.  DVC stage `evaluate`."""

from collections.abc import Iterable
from functools import partial
from pathlib import Path

from industnerf.artifacts.cloud import cloud_files
from industnerf.artifacts.scores import gather_scores
from industnerf.cli import run_as_stage
from industnerf.config import StageParams
from industnerf.metrics.image_and_confidence_metrics import image_and_confidence_files
from industnerf.metrics.protocol import score_failure, score_part
from industnerf.stage import Batch, Task, read_failures, read_index, run_methods


def main(cfg: StageParams, parts: str, views: str, truth: str, clouds: str, out: str) -> None:
    part_ids, batches = read_index(Path(truth)), {}
    for name in cfg.methods:
        folders = tuple(map(Path, (parts, truth, views, f"{clouds}/{name}")))
        tasks = evaluation_tasks(cfg, folders, part_ids, set(read_failures(folders[-1])))
        batches[name] = Batch(tasks, Path(out) / name)
    # What cannot be scored says nothing of the method: without its score there is no mean.
    options = {"failures_are_losses": True, "shares_processes": True}
    try:
        run_methods("evaluate", batches, Path(out), "strict", **options)
    finally:
        for name, batch in batches.items():
            if (batch.out / "index.json").exists() and not read_failures(batch.out):
                gather_scores(batch.out, name)


def evaluation_tasks(
    cfg: StageParams, folders: tuple[Path, ...], part_ids: Iterable[str], failed: set[str]
) -> list[Task]:
    """`folders` are those of parts, truth, views and clouds."""
    tasks = []
    for part_id in part_ids:
        part_dir, truth_dir, views_dir, cloud_dir = (folder / part_id for folder in folders)
        inputs = (part_dir / "mesh.npz", truth_dir)
        make = partial(score_failure, part_dir, truth_dir, settings=cfg.evaluate, seed=cfg.seed)
        if part_id not in failed:
            inputs = (
                *inputs,
                *cloud_files(cloud_dir),
                *image_and_confidence_files(views_dir, cloud_dir),
            )
            paths = (part_dir, truth_dir, views_dir, cloud_dir)
            make = partial(score_part, *paths, settings=cfg.evaluate, seed=cfg.seed)
        tasks.append(Task(part_id, make, [cfg.evaluate, cfg.seed, part_id in failed], inputs))
    return tasks


if __name__ == "__main__":
    run_as_stage(main, "evaluate")
