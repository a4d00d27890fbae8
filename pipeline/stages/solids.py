"""Read your own CAD files into solids in mm, once each.  DVC stage `solids`."""

from functools import partial
from pathlib import Path

from industnerf.cli import run_as_stage
from industnerf.config import StageParams
from industnerf.parts.io.cad_files import find_cad_files, print_unread_files
from industnerf.parts.io.readers import write_solids
from industnerf.parts.io.readers.sidecars import find_sidecars
from industnerf.stage import Task, run_stage


def main(cfg: StageParams, source: str, out: str) -> None:
    units, override_units = cfg.parts.units, cfg.parts.override_units
    files = []
    if cfg.parts.source == "path":
        files = find_cad_files(Path(source), cfg.parts.pattern, cfg.parts.select)
        print_unread_files("solids", Path(source), Path(source).glob(cfg.parts.pattern))
    tasks = [
        Task(
            file.file_id,
            partial(write_solids, file.path, units, override_units=override_units),
            [file.path.name, units, override_units],
            (file.path, *find_sidecars(file.path)),
        )
        for file in files
    ]
    limits = {"limit_s": cfg.parts.time_limit_s, "memory_mb": cfg.parts.memory_limit_mb}
    run_stage("solids", tasks, Path(out), cfg.on_failure, **limits)


if __name__ == "__main__":
    run_as_stage(main, "solids")
