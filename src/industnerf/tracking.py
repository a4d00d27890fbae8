"""MLflow: one run per distinct result.  Never fatal: the result is safe on disk before it.

INDUSTNERF_MLFLOW    the folder of mlflow.db and mlruns; default: the current one
"""

import fcntl
import json
import logging
import os
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from industnerf.config import flat, read_yaml
from industnerf.tracked import loss_curve, mean_costs, per_part, preview

EXPERIMENT = "industnerf"
# Without it the UI opens on a page for language models instead of the table of runs.
TABLE_OF_RUNS = {"mlflow.experimentKind": "custom_model_development"}


def home() -> Path:
    """Where the tracking database lives: an absolute path, or a run elsewhere would start anew."""
    return Path(os.environ.get("INDUSTNERF_MLFLOW", ".")).absolute()


def prepare() -> None:
    """Create database and experiment if they are not there.

    MLflow's first connection corrupts the database if two processes make it at once, so it is
    made under a lock; call this before any fan-out.
    """
    if _is_on():
        with _locked():
            _client()


def _is_on() -> bool:
    return os.environ.get("INDUSTNERF_MLFLOW") != "off"


def log_report(
    report: Path, params: Mapping[str, Any], name: str | None = None, **tags: str
) -> None:
    """Log the report in `report` as one run, unless one with the same results is there."""
    if not _is_on():
        return
    try:
        with _locked():
            _log(report, params, name, tags)
    except Exception as error:  # whatever MLflow or SQLite throws, the results are on disk
        print(
            f"MLflow: not logged ({type(error).__name__}: {error}). The result is safe in {report};"
            " `make ui` logs it later.",
            file=sys.stderr,
        )


def _log(report: Path, params: Mapping[str, Any], name: str | None, tags: dict[str, str]) -> None:
    summary = json.loads((report / "summary.json").read_text())
    mlflow, experiment = _client()
    inputs = summary["inputs"] + tags.get("point", "")
    same = mlflow.search_runs(
        [experiment], f"tags.inputs = '{inputs}'", max_results=1, output_format="list"
    )
    if same:
        return
    mlflow.set_experiment(experiment_id=experiment)
    with mlflow.start_run(run_name=name or summary["preset"]) as run:
        mlflow.set_tags({"inputs": inputs, **git_state(), **tags})
        mlflow.log_params(flat(params))
        mlflow.log_metrics(summary["metrics"] | mean_costs(report))
        mlflow.log_table(per_part(report), "per_part.json")
        mlflow.log_artifacts(str(report), "report")
        _log_methods(mlflow, run.info.run_id, report.parent / "data")


def _log_methods(mlflow: Any, run_id: str, data: Path) -> None:
    """The loss curves and the picture of every method that has them, by its name."""
    now, client = int(1000 * time.time()), mlflow.MlflowClient()
    for clouds in sorted((data / "clouds").glob("*/")):
        states = data / "states" / clouds.name
        curves = {
            "loss": loss_curve(clouds),
            "fit.loss": loss_curve(states),
            "fit.validation": loss_curve(states, "*/validation"),
        }
        metrics = [
            mlflow.entities.Metric(f"{clouds.name}.{name}", loss, now, step)
            for name, curve in curves.items()
            for step, loss in curve.items()
        ]
        client.log_batch(run_id, metrics)  # one by one they would take seconds
        picture = preview(clouds, data / "views")
        if picture is not None:
            mlflow.log_image(picture, artifact_file=f"previews/{clouds.name}.png")


def _client() -> tuple[Any, str]:
    """MLflow, without telemetry and without the lines that a fresh database prints."""
    os.environ["MLFLOW_DISABLE_TELEMETRY"] = "true"
    import mlflow

    for name in ("alembic", "mlflow"):
        logging.getLogger(name).setLevel(logging.WARNING)  # after the import, which sets its own
    mlflow.set_tracking_uri(f"sqlite:///{home() / 'mlflow.db'}")
    found = mlflow.get_experiment_by_name(EXPERIMENT)
    if found:
        return mlflow, found.experiment_id
    artifacts = (home() / "mlruns").as_uri()
    return mlflow, mlflow.create_experiment(EXPERIMENT, artifacts, tags=TABLE_OF_RUNS)


@contextmanager
def _locked() -> Iterator[None]:
    home().mkdir(parents=True, exist_ok=True)
    with (home() / "mlflow.db.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def git_state() -> dict[str, str]:
    """Commit, and whether the tree differs from it; empty outside a repository."""

    def git(*arguments: str) -> str:
        return subprocess.run(
            ["git", *arguments], capture_output=True, text=True, check=True
        ).stdout.strip()

    try:
        return {
            "git.commit": git("rev-parse", "HEAD"),
            "git.dirty": str(bool(git("status", "--porcelain"))).lower(),
        }
    except (OSError, subprocess.CalledProcessError):
        return {}


def backfill(root: Path) -> None:
    """Log every report below `root` that is not logged yet."""
    prepare()
    for summary in sorted([*root.glob("reports/summary.json"), *root.glob("runs/**/summary.json")]):
        params = summary.parent.parent / "params.yaml"
        log_report(summary.parent, read_yaml(params) if params.exists() else {})


if __name__ == "__main__":
    backfill(Path.cwd())
