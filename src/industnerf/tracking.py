"""MLflow: one run per distinct result.  Never fatal: the result is safe on disk before it.

INDUSTNERF_MLFLOW    the folder of mlflow.db and mlruns; default: the current one
"""

import fcntl
import hashlib
import json
import logging
import os
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

from industnerf import environment, git
from industnerf.artifacts.files import write_json
from industnerf.cli import exit_with_message
from industnerf.config import flatten, read_yaml
from industnerf.errors import BadArtifact, BadParams
from industnerf.mlflow_artifacts import loss_curve, mean_costs, per_part_table, preview_image

EXPERIMENT = "industnerf"
# Without it the UI opens on a page for language models instead of the table of runs.
TABLE_OF_RUNS = {"mlflow.experimentKind": "custom_model_development"}
LOCK_PATIENCE_S = 60.0  # logging takes seconds; a process that is stopped holds the lock for ever
TAGS_FILE = "label.json"  # of a report: the tags of its run, whenever it is logged


def database_dir() -> Path:
    """Where the tracking database lives: an absolute path, or a run elsewhere would start anew."""
    return environment.main_checkout() / (environment.get_str("INDUSTNERF_MLFLOW") or ".")


def prepare_database() -> None:
    """Create database and experiment if they are not there.

    MLflow's first connection corrupts the database if two processes make it at once, so it is
    made under a lock; call this before any fan-out.  Says so if MLflow cannot open it.
    """
    try:
        _open_database()
    except BadArtifact as error:
        print(error, file=sys.stderr)


def _open_database() -> None:
    """Raises BadArtifact if MLflow cannot open the database."""
    if not is_enabled():
        return
    try:
        with _locked():
            _client()
    except Exception as error:  # whatever MLflow or SQLite throws
        raise BadArtifact(
            f"MLflow cannot open {database_dir() / 'mlflow.db'} ({type(error).__name__}: {error}); "
            "`python -m industnerf.doctor database` says what mends it. Results do not need it."
        ) from None


def is_enabled() -> bool:
    """Whether anything is to be logged."""
    return os.environ.get("INDUSTNERF_MLFLOW") != "off"


def save_tags(report: Path, **tags: str) -> None:
    """Note how the run of the report in `report` is to be tagged, today's commit included.

    Of a sweep the tag `point` says what was set, and is its name.
    """
    write_json(report / TAGS_FILE, {**git_state(), **tags})


def log_report(report: Path, params: Mapping[str, Any]) -> None:
    """Log the report in `report` as one run, unless one with the same results is there."""
    if not is_enabled():
        return
    try:
        with _locked():
            _log(report, params)
    except Exception as error:  # whatever MLflow or SQLite throws, the results are on disk
        print(
            f"MLflow: not logged ({type(error).__name__}: {error}). The result is safe in {report};"
            " `make ui` logs it later; if that fails too, `python -m industnerf.doctor database`"
            " says what mends it.",
            file=sys.stderr,
        )


def _log(report: Path, params: Mapping[str, Any]) -> None:
    summary = json.loads((report / "summary.json").read_text(encoding="utf-8"))
    tags_path = report / TAGS_FILE
    tags = (
        json.loads(tags_path.read_text(encoding="utf-8")) if tags_path.exists() else {}
    )  # made at a commit not noted
    mlflow, experiment = _client()
    results = _result_id(summary["results"], tags.get("point", ""))
    existing = mlflow.search_runs(
        [experiment], f"tags.results = '{results}'", max_results=1, output_format="list"
    )
    if existing:
        return
    # first: what cannot be read leaves no run behind
    table = per_part_table(report)
    methods = _method_logs(report.parent / "data", params.get("methods"))
    mlflow.set_experiment(experiment_id=experiment)
    with mlflow.start_run(run_name=tags.get("point", summary["preset"])) as run:
        mlflow.set_tags(tags)
        mlflow.log_params(flatten(params))
        mlflow.log_metrics(summary["metrics"] | mean_costs(report))
        mlflow.log_table(table, "per_part.json")
        mlflow.log_artifacts(str(report), "report")
        _log_methods(mlflow, run.info.run_id, methods)
        mlflow.set_tag("results", results)  # last: what is half logged is logged anew


def _result_id(results: str, point: str) -> str:
    """What is searched for: results and point; a hash, where quotes would end the search early."""
    combined = results + point
    return hashlib.sha256(combined.encode()).hexdigest() if "'" in point else combined


@dataclass(frozen=True)
class _MethodLog:
    """What there is to see of a method beside its scores."""

    name: str
    curves: dict[str, dict[int, float]]  # name -> step -> loss
    preview: Any


def _method_logs(data: Path, names: Sequence[str] | None) -> list[_MethodLog]:
    """Those of `names`, or all of which there are clouds: DVC leaves those of methods dropped."""
    folders = sorted((data / "clouds").glob("*/"))
    return [
        _method_log(data, folder) for folder in folders if names is None or folder.name in names
    ]


def _method_log(data: Path, clouds: Path) -> _MethodLog:
    states = data / "states" / clouds.name
    curves = {
        "loss": loss_curve(clouds),
        "fit.loss": loss_curve(states),
        "fit.validation": loss_curve(states, "*/validation"),
    }
    return _MethodLog(clouds.name, curves, preview_image(clouds, data / "views"))


def _log_methods(mlflow: Any, run_id: str, methods: Sequence[_MethodLog]) -> None:
    """The loss curves and the picture of every method that has them, by its name."""
    timestamp_ms, client = int(1000 * time.time()), mlflow.MlflowClient()
    for method in methods:
        metrics = [
            mlflow.entities.Metric(f"{method.name}.{name}", loss, timestamp_ms, step)
            for name, curve in method.curves.items()
            for step, loss in curve.items()
        ]
        client.log_batch(run_id, metrics)  # one by one they would take seconds
        if method.preview is not None:
            mlflow.log_image(method.preview, artifact_file=f"previews/{method.name}.png")


def _client() -> tuple[Any, str]:
    """MLflow, without telemetry and without the lines that a fresh database prints."""
    os.environ["MLFLOW_DISABLE_TELEMETRY"] = "true"
    import mlflow

    for name in ("alembic", "mlflow"):
        logging.getLogger(name).setLevel(logging.WARNING)  # after the import, which sets its own
    mlflow.set_tracking_uri(f"sqlite:///{database_dir() / 'mlflow.db'}")
    experiment = mlflow.get_experiment_by_name(EXPERIMENT)
    if experiment:
        return mlflow, experiment.experiment_id
    artifacts = (database_dir() / "mlruns").as_uri()
    return mlflow, mlflow.create_experiment(EXPERIMENT, artifacts, tags=TABLE_OF_RUNS)


@contextmanager
def _locked() -> Iterator[None]:
    database_dir().mkdir(parents=True, exist_ok=True)
    with (database_dir() / "mlflow.db.lock").open("w") as lock:
        deadline = time.monotonic() + LOCK_PATIENCE_S
        while not _try_lock(lock):
            if time.monotonic() > deadline:
                raise TimeoutError(f"{lock.name} is held for more than {LOCK_PATIENCE_S:g} s")
            time.sleep(0.1)
        yield


def _try_lock(lock: IO[str]) -> bool:
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True


def git_state() -> dict[str, str]:
    """Commit, and whether the tree differs from it; empty outside a repository."""
    try:
        return {
            "git.commit": git.head_commit(),
            "git.dirty": str(bool(git.changed_paths())).lower(),
        }
    except BadArtifact:
        return {}


def backfill(root: Path) -> None:
    """Log every report below `root` that is not logged yet; says which one cannot be.

    Raises BadArtifact if MLflow cannot open its database.
    """
    _open_database()
    for summary in sorted([*root.glob("reports/summary.json"), *root.glob("runs/**/summary.json")]):
        params = summary.parent.parent / "params.yaml"
        try:
            values = read_yaml(params) if params.exists() else {}
        except BadParams as error:
            print(f"MLflow: {summary.parent} is not logged: {error}", file=sys.stderr)
        else:
            log_report(summary.parent, values)


def main() -> None:
    """`python -m industnerf.tracking`: bring MLflow up to date, print where its database is."""
    if not is_enabled():
        raise BadParams("INDUSTNERF_MLFLOW is off: there is nothing to look at")
    backfill(Path.cwd())
    print(f"sqlite:///{database_dir() / 'mlflow.db'}")


if __name__ == "__main__":
    exit_with_message(main)
