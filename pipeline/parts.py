"""Bring the embedded catalogue, or your own CAD files, to cleaned meshes.  DVC stage `parts`."""

from pathlib import Path

from industnerf.artifacts.part import write_manifest
from industnerf.cli import run_as_stage
from industnerf.config import Masked
from industnerf.parts.sources import find_sources
from industnerf.stage import Task, run_stage


def main(cfg: Masked, source: str, out: str) -> None:
    tasks = [
        Task(found.part_id, found.make, found.settings, found.files)
        for found in find_sources(Path(source), cfg.parts, cfg.seed)
    ]
    run_stage("parts", tasks, Path(out), cfg.on_failure)
    write_manifest(Path(out))


if __name__ == "__main__":
    run_as_stage(main, "parts")
