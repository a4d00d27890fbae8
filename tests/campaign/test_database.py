"""The MLflow database locked, missing, of an old schema, read-only, on a full disk.

None of it may cost a result, or more than a minute.
"""

import fcntl
import sqlite3
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path

import pytest

from tests.campaign.conftest import small_tmpfs
from tests.doctor.test_database import OLDER
from tests.pipeline.conftest import Project, finished_run

__all__ = ["finished_run"]
pytestmark = pytest.mark.campaign
MAX_SECONDS = 150


@contextmanager
def locked_by_sqlite(folder: Path) -> Iterator[None]:
    make_database(folder)
    with closing(sqlite3.connect(folder / "mlflow.db", isolation_level=None)) as connection:
        connection.execute("BEGIN EXCLUSIVE")
        yield


@contextmanager
def locked_by_a_stopped_process(folder: Path) -> Iterator[None]:
    make_database(folder)
    with (folder / "mlflow.db.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


@contextmanager
def missing(folder: Path) -> Iterator[None]:
    yield


@contextmanager
def of_an_old_schema(folder: Path) -> Iterator[None]:
    subprocess.run([sys.executable, "-c", OLDER, f"sqlite:///{folder / 'mlflow.db'}"], check=True)
    yield


@contextmanager
def of_a_newer_schema(folder: Path) -> Iterator[None]:
    make_database(folder)
    with closing(sqlite3.connect(folder / "mlflow.db", isolation_level=None)) as connection:
        connection.execute("UPDATE alembic_version SET version_num = 'ffffffffffff'")
    yield


@contextmanager
def read_only(folder: Path) -> Iterator[None]:
    with small_tmpfs(folder, "64m"):
        make_database(folder)
        subprocess.run(["mount", "-o", "remount,ro", str(folder)], check=True)
        yield


@contextmanager
def on_a_full_disk(folder: Path) -> Iterator[None]:
    with small_tmpfs(folder, "64k"):
        yield


def make_database(folder: Path) -> None:
    script = "import mlflow, sys; mlflow.set_tracking_uri(sys.argv[1]); mlflow.set_experiment('a')"
    uri = f"sqlite:///{folder / 'mlflow.db'}"
    subprocess.run([sys.executable, "-c", script, uri], check=True, capture_output=True)


STATES = [
    (missing, True),
    (of_an_old_schema, True),  # MLflow brings it up to date
    (of_a_newer_schema, False),
    (locked_by_sqlite, False),
    (locked_by_a_stopped_process, False),
    (read_only, False),
    (on_a_full_disk, False),
]


@pytest.mark.parametrize(("state", "is_logged"), STATES, ids=[s.__name__ for s, _ in STATES])
def test_a_result_needs_no_database(
    state: Callable, is_logged: bool, finished_run: Project, tmp_path: Path, print_row: Callable
):
    expected = finished_run.outputs()
    with state(tmp_path):
        environment = finished_run.environment | {"INDUSTNERF_MLFLOW": str(tmp_path)}
        start = time.monotonic()
        ended = subprocess.run(
            ["dvc", "repro", "-f", "-s", "report"],
            cwd=finished_run.folder,
            env=environment,
            capture_output=True,
            text=True,
            timeout=2 * MAX_SECONDS,
        )
        seconds = time.monotonic() - start
    said = [line for line in ended.stderr.splitlines() if line.startswith("MLflow: not logged")]
    print_row(f"MLflow {state.__name__}: exit code {ended.returncode}, {seconds:.0f} s, {said[:1]}")
    assert ended.returncode == 0, ended.stdout + ended.stderr
    assert finished_run.outputs() == expected
    assert bool(said) != is_logged
    assert seconds < MAX_SECONDS
