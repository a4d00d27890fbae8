"""Hydra over the whole pipeline, in process, one point after the other, sharing the store.

python -m pipeline.sweep --multirun views.count=8,16,32 'methods=[hull]'
python -m pipeline.sweep experiment=demo seed=1
"""

import shutil
import sys
import traceback
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import hydra
from hydra.core.hydra_config import HydraConfig
from hydra.experimental.callback import Callback
from hydra.types import RunMode
from omegaconf import DictConfig, OmegaConf

from industnerf.artifacts.files import write_json
from industnerf.cli import exit_with_message
from industnerf.config import PARAMS, build, read_yaml
from industnerf.errors import BadArtifact, BadParams, SuiteError
from industnerf.renamed import check_overrides, flatten_preset
from industnerf.report.publish.provenance import commit_stamp
from industnerf.report.sweeps.preset_table import TABLES
from industnerf.report.sweeps.sweep_report import write_sweep_report
from industnerf.schema import Params
from industnerf.tracking import log_report, log_sweep, prepare_database, save_tags
from pipeline.in_process import run_pipeline

CONF_DIR = Path(__file__).parents[1] / "conf"
PLOT_FILE = "sweep.png"
GROUPS = ("experiment", "reading", "ablation")  # folders of conf


class SweepCallback(Callback):
    """Before a sweep the tracking database is made, and its commit noted; after it stand a table,
    a plot, and a run in the database.
    """

    def on_multirun_start(self, config: DictConfig, **_: Any) -> None:
        folder = Path(config.hydra.sweep.dir)
        try:
            clear_previous_sweep(folder)
        except BadArtifact as error:  # of which Hydra would make a warning
            print(f"error: {error}", file=sys.stderr)
            sys.exit(1)
        write_json(folder / "made.json", commit_stamp())
        prepare_database()

    def on_multirun_end(self, config: DictConfig, **_: Any) -> None:
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
    for name in (*(table for _, table in TABLES), PLOT_FILE):
        (folder / name).unlink(missing_ok=True)


def check_names(arguments: Sequence[str]) -> None:
    """Raise BadParams if a key, a file or a preset of the command line has another name now."""
    overrides = [argument.lstrip("+~").partition("=")[::2] for argument in arguments]
    check_overrides(overrides)
    for name in (
        name for key, value in overrides if key == "experiment" for name in value.split(",")
    ):
        if (path := CONF_DIR / "experiment" / f"{name}.yaml").exists():
            check_overrides(flatten_preset(read_yaml(path)))


def check_choices(choices: Mapping[str, str | None]) -> None:
    """Raise BadParams if a group's choice has no file: Hydra skips what is optional and missing."""
    for group in GROUPS:
        available = sorted(path.stem for path in (CONF_DIR / group).glob("*.yaml"))
        if (name := choices.get(group)) not in (None, "null", *available):
            raise BadParams(f"{group}={name} is unknown, known are {', '.join(available)}")


@hydra.main(version_base="1.3", config_path="../conf", config_name="config")
def main(config: DictConfig) -> None:
    hydra_config = HydraConfig.get()
    folder, overrides = Path(hydra_config.runtime.output_dir), " ".join(hydra_config.overrides.task)
    values = OmegaConf.to_container(config, resolve=True)
    try:
        check_choices(hydra_config.runtime.choices)
        _run_point(folder, values, overrides)
    except Exception as error:
        if not isinstance(error, SuiteError):
            traceback.print_exc()
        print(f"error at {overrides}: {error}", file=sys.stderr)
        if hydra_config.mode == RunMode.RUN:
            sys.exit(1)  # a sweep goes on with its other points, and ends with SweepCallback


def _run_point(folder: Path, values: Any, overrides: str) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    OmegaConf.save(values, folder / "params.yaml")
    run_pipeline(build(Params, values, "the composed configuration"), folder)
    save_tags(folder / "reports", point=overrides)
    log_report(folder / "reports", values)


if __name__ == "__main__":
    exit_with_message(lambda: (check_names(sys.argv[1:]), main()))
