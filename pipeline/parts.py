"""Bring the embedded catalogue, or the solids of your own files, to parts.  DVC stage `parts`."""

from pathlib import Path

from industnerf.artifacts.part import write_manifest
from industnerf.cli import run_as_stage
from industnerf.config import Masked
from industnerf.parts.sources import embedded_parts, own_parts
from industnerf.stage import Task, read_failures, read_index, run_stage


def main(cfg: Masked, source: str, solids: str, out: str) -> None:
    if cfg.parts.source == "embedded":
        found = embedded_parts(Path(source), cfg.parts.select)
    else:
        found = own_parts(Path(source), Path(solids), set(read_index(Path(solids))), cfg.parts)
    tasks = [Task(part.part_id, part.make, part.settings, part.files) for part in found]
    limits = {"limit_s": cfg.parts.time_limit_s, "memory_mb": cfg.parts.memory_limit_mb}
    before = read_failures(Path(solids))
    run_stage("parts", tasks, Path(out), cfg.on_failure, failed_before=before, **limits)
    write_manifest(Path(out))


if __name__ == "__main__":
    run_as_stage(main, "parts")
