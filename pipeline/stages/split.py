"""Set the dev parts apart, and hold out whole families in folds.  DVC stage `split`."""

from pathlib import Path

from industnerf.artifacts.part import load_parts
from industnerf.artifacts.split import save_split
from industnerf.cli import run_as_stage
from industnerf.config import StageParams
from industnerf.parts.split import assign_splits


def main(cfg: StageParams, parts: str, out: str) -> None:
    save_split(Path(out), assign_splits(load_parts(Path(parts)), cfg.split))


if __name__ == "__main__":
    run_as_stage(main, "split")
