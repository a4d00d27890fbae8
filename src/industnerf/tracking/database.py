"""The tracking database: where it is, whose turn it is, and the experiment in it."""

import fcntl
import logging
import os
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any

from industnerf import environment
from industnerf.errors import BadArtifact
from industnerf.tracking.views import METHODS, methods_view, view_tag

EXPERIMENT = "industnerf"
# The first key says how runs are arranged; without the second the UI opens on a page for language
# models instead of the table of runs.
EXPERIMENT_TAGS = {
    "industnerf.runs": "per method",
    "mlflow.experimentKind": "custom_model_development",
}
OLDER_EXPERIMENT = f"{EXPERIMENT} (one run per study)"
LOCK_PATIENCE_S = 60.0  # logging takes seconds; a process that is stopped holds the lock for ever


def database_dir() -> Path:
    """Where the tracking database lives: an absolute path, or a run elsewhere would start anew."""
    return environment.main_checkout() / (environment.get_str("INDUSTNERF_MLFLOW") or ".")


def is_enabled() -> bool:
    """Whether anything is to be logged."""
    return os.environ.get("INDUSTNERF_MLFLOW") != "off"


@contextmanager
def open_locked() -> Iterator[tuple[Any, str]]:
    """MLflow's client and the experiment's id, for this process alone.

    MLflow's first connection corrupts the database if two processes make it at once.  Raises
    TimeoutError if another holds it for more than LOCK_PATIENCE_S, and whatever MLflow or SQLite
    throw.
    """
    with _locked():
        client = _client()
        yield client, _experiment(client)


def prepare_database() -> None:
    """Say so if MLflow cannot open the database: before hours of work, not after them."""
    if is_enabled():
        try:
            check_database()
        except BadArtifact as error:
            print(error, file=sys.stderr)


def check_database() -> str:
    """The experiment's id; raises BadArtifact if MLflow cannot open the database."""
    try:
        with open_locked() as (_, experiment):
            return experiment
    except Exception as error:  # whatever MLflow or SQLite throws
        raise BadArtifact(
            f"MLflow cannot open {database_dir() / 'mlflow.db'} ({type(error).__name__}: {error}); "
            "`python -m industnerf.doctor database` says what mends it. Results do not need it."
        ) from None


def _client() -> Any:
    """MLflow, without telemetry and without the lines that a fresh database prints."""
    os.environ["MLFLOW_DISABLE_TELEMETRY"] = "true"
    import mlflow

    for name in ("alembic", "mlflow"):
        logging.getLogger(name).setLevel(logging.WARNING)  # after the import, which sets its own
    return mlflow.MlflowClient(f"sqlite:///{database_dir() / 'mlflow.db'}")


def _experiment(client: Any) -> str:
    """Its id; made where there is none, or one that is arranged as it was in earlier versions."""
    experiment = client.get_experiment_by_name(EXPERIMENT)
    if experiment and not EXPERIMENT_TAGS.items() <= experiment.tags.items():
        client.rename_experiment(experiment.experiment_id, OLDER_EXPERIMENT)
        print(
            f"MLflow: earlier runs, one per study, stay in the experiment {OLDER_EXPERIMENT!r}; "
            "`make ui` logs the reports on disk anew, with a run per method",
            file=sys.stderr,
        )
        experiment = None
    if experiment is None:
        artifacts = (database_dir() / "mlruns").as_uri()
        tags = EXPERIMENT_TAGS | {view_tag(METHODS): methods_view()}
        return client.create_experiment(EXPERIMENT, artifacts, tags)
    if experiment.tags.get(view_tag(METHODS)) != methods_view():  # that of another version
        client.set_experiment_tag(experiment.experiment_id, view_tag(METHODS), methods_view())
    return experiment.experiment_id


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
