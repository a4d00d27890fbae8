"""Hydra over the whole pipeline, in process, one point after the other, sharing the store.

python -m pipeline.sweep --multirun views.count=8,16,32 'methods=[hull]'
python -m pipeline.sweep experiment=demo seed=1
"""

import shutil
import sys
import traceback
from pathlib import Path
from typing import Any

import hydra
from hydra.core.hydra_config import HydraConfig
from hydra.experimental.callback import Callback
from hydra.types import RunMode
from omegaconf import DictConfig, OmegaConf

from industnerf.cli import exit_with_message
from industnerf.config import PARAMS
from industnerf.errors import BadArtifact, SuiteError
from industnerf.schema import Params
from pipeline.command_line import (
    check_command_line,
    check_points,
    check_values,
    grid_points,
    tuning_ends,
)
from pipeline.tuning import check_tuning, objective

# What only a point that runs needs is imported there: a refusal must not wait for it.
PLOT_FILE = "sweep.png"


class SweepCallback(Callback):
    """Before a sweep its points are checked, the tracking database is made, and its commit noted;
    after it stand a table, a plot and a run in the database.
    """

    def on_multirun_start(self, config: DictConfig, **_: Any) -> None:
        folder = Path(config.hydra.sweep.dir)
        try:
            if config.hydra.runtime.choices["hydra/sweeper"] == "optuna":
                check_tuning([check_points(config, [end])[0] for end in tuning_ends(config)])
            else:
                check_points(config, grid_points(config))
            clear_previous_sweep(folder)
        except SuiteError as error:  # of which Hydra would make a warning
            print(f"error: {error}", file=sys.stderr)
            sys.exit(error.exit_code)
        from industnerf.artifacts.files import write_json
        from industnerf.report.publish.provenance import commit_stamp
        from industnerf.tracking import prepare_database

        write_json(folder / "made.json", commit_stamp())
        prepare_database()

    def on_multirun_end(self, config: DictConfig, **_: Any) -> None:
        from industnerf.report.sweeps.sweep_report import write_sweep_report
        from industnerf.tracking import log_sweep

        folder = Path(config.hydra.sweep.dir)
        try:
            failed = write_sweep_report(folder)
        except Exception:  # of which Hydra would make a warning, and end as if all were well
            traceback.print_exc()
            failed = True
        log_sweep(folder)
        if failed:
            sys.exit(1)


def clear_previous_sweep(folder: Path) -> None:
    """Remove what an earlier sweep into `folder` left: what it made is in the store.

    Raises BadArtifact if something lies there, and no sweep has.
    """
    from hydra_plugins.optuna_sweeper import RESULTS
    from industnerf.report.sweeps.preset_table import TABLES

    names = {path.name for path in folder.iterdir()} if folder.exists() else set()
    if not names - {"made.json"}:
        return
    if "multirun.yaml" not in names:  # which Hydra writes
        raise BadArtifact(f"{folder} holds something else than a sweep; name another folder")
    for point in folder.iterdir():
        # one that failed early has no params.yaml, and nothing else; what has may be somebody's
        is_point = point.is_dir() and point.name.isdigit()
        if is_point and ((point / PARAMS).exists() or not any(point.iterdir())):
            shutil.rmtree(point)
    for name in (*(table for _, table in TABLES), PLOT_FILE, RESULTS):
        (folder / name).unlink(missing_ok=True)


@hydra.main(version_base="1.3", config_path="../conf", config_name="config")
def main(config: DictConfig) -> float | None:
    hydra_config = HydraConfig.get()
    folder, overrides = Path(hydra_config.runtime.output_dir), " ".join(hydra_config.overrides.task)
    try:
        params = check_values(config, hydra_config.runtime.choices)
        return _run_point(folder, params, OmegaConf.to_container(config, resolve=True), overrides)
    except Exception as error:
        if not isinstance(error, SuiteError):
            traceback.print_exc()
        print(f"error at {overrides}: {error}", file=sys.stderr)
        if hydra_config.mode == RunMode.RUN:
            # a sweep goes on with its other points, and ends with SweepCallback
            sys.exit(error.exit_code if isinstance(error, SuiteError) else 1)
        return None


def _run_point(folder: Path, params: Params, values: Any, overrides: str) -> float | None:
    """Run one point; returns what a tuner is to make small, None of several methods or splits."""
    from industnerf.tracking import log_report, save_tags
    from pipeline.in_process import run_pipeline

    folder.mkdir(parents=True, exist_ok=True)
    OmegaConf.save(values, folder / PARAMS)
    run_pipeline(params, folder)
    save_tags(folder / "reports", point=overrides)
    log_report(folder / "reports", values)
    return objective(folder)


if __name__ == "__main__":
    exit_with_message(lambda: (check_command_line(sys.argv[1:]), main()))
