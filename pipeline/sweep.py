"""Hydra over the whole pipeline, in process, one point after the other, sharing the store.

python -m pipeline.sweep --multirun views.count=8,16,32 'methods=[hull]'
python -m pipeline.sweep experiment=demo seed=1
"""

import sys
from pathlib import Path
from typing import Any

import hydra
from hydra.core.hydra_config import HydraConfig
from hydra.experimental.callback import Callback
from omegaconf import DictConfig, OmegaConf

from industnerf.cli import exit_with_message
from industnerf.config import build
from industnerf.report.sweep import write_sweep
from industnerf.schema import Params
from industnerf.tracking import log_report, prepare
from pipeline.chain import run_chain


class SweepEnd(Callback):
    """Before a sweep the tracking database is made; after it stand a table and a plot."""

    def on_multirun_start(self, config: DictConfig, **_: Any) -> None:
        prepare()

    def on_multirun_end(self, config: DictConfig, **_: Any) -> None:
        if write_sweep(Path(config.hydra.sweep.dir)):
            sys.exit(1)


@hydra.main(version_base="1.3", config_path="../conf", config_name="config")
def main(config: DictConfig) -> None:
    run = HydraConfig.get()
    folder, overrides = Path(run.runtime.output_dir), list(run.overrides.task)
    values = OmegaConf.to_container(config, resolve=True)
    exit_with_message(lambda: _point(folder, values, overrides))


def _point(folder: Path, values: Any, overrides: list[str]) -> None:
    params = build(Params, values, "the composed configuration")
    OmegaConf.save(values, folder / "params.yaml")
    run_chain(params, folder)
    log_report(folder / "reports", values, " ".join(overrides), point=" ".join(overrides))


if __name__ == "__main__":
    main()
