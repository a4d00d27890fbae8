"""Bring the embedded catalogue, or the solids of your own files, to parts.  DVC stage `parts`."""

from pathlib import Path

from industnerf.artifacts.part import write_manifest
from industnerf.artifacts.part_warnings import print_part_warnings
from industnerf.cli import run_as_stage
from industnerf.config import StageParams
from industnerf.parts.catalogue.sources import embedded_parts, user_parts
from industnerf.stage import Task, read_failures, read_index, run_stage


def main(cfg: StageParams, source: str, solids: str, out: str) -> None:
    if cfg.parts.source == "embedded":
        sources = embedded_parts(Path(source), cfg.parts.select)
    else:
        sources = user_parts(Path(source), Path(solids), set(read_index(Path(solids))), cfg.parts)
    tasks = [Task(part.part_id, part.make, part.settings, part.files) for part in sources]
    limits = {"limit_s": cfg.parts.time_limit_s, "memory_mb": cfg.parts.memory_limit_mb}
    earlier_failures = read_failures(Path(solids))
    run_stage(
        "parts", tasks, Path(out), cfg.on_failure, earlier_failures=earlier_failures, **limits
    )
    write_manifest(Path(out))
    print_part_warnings(Path(out), "parts")


if __name__ == "__main__":
    run_as_stage(main, "parts")
