"""The MLflow database: of another version, damaged, half made, or none at all."""

import shutil
import signal
import sqlite3
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from industnerf.doctor import database
from industnerf.doctor.database import known_versions
from tests.doctor.conftest import WorkingCopy

# The tables as they were before the last migration.
OLDER = """
import sys
import sqlalchemy
from alembic import command, script
from mlflow.store.db.utils import _get_alembic_config
from mlflow.store.tracking.dbmodels.initial_models import Base
Base.metadata.create_all(sqlalchemy.create_engine(sys.argv[1]))
config = _get_alembic_config(sys.argv[1])
last = script.ScriptDirectory.from_config(config)
command.upgrade(config, last.get_revision(last.get_current_head()).down_revision)
"""

# All tables, of which those of the migrations from `webhooks` on are not known to be there.
BEFORE_WEBHOOKS = """
import sys
import sqlalchemy
from alembic import script
from mlflow.store.db.utils import _get_alembic_config
migrations = script.ScriptDirectory.from_config(_get_alembic_config(sys.argv[1])).walk_revisions()
(made,) = (one for one in migrations if "webhooks" in (one.doc or ""))
with sqlalchemy.create_engine(sys.argv[1]).begin() as connection:
    text = f"UPDATE alembic_version SET version_num = '{made.down_revision}'"
    connection.execute(sqlalchemy.text(text))
"""

# A process that dies in mid-transaction; what does not fit into its cache is in the file already.
KILLED = """
import os, signal, sqlite3, sys
connection = sqlite3.connect(sys.argv[1])
connection.execute("PRAGMA cache_size = 1")
connection.execute("DELETE FROM experiments")
connection.execute("CREATE TABLE filler AS SELECT randomblob(1000000)")
os.kill(os.getpid(), signal.SIGKILL)
"""


def python(script: str, *arguments: str) -> None:
    process = subprocess.run(
        [sys.executable, "-c", script, *arguments], check=False, capture_output=True, text=True
    )
    assert process.returncode == 0, process.stderr


@pytest.fixture(scope="module")
def fresh_database(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A database as MLflow makes it."""
    path = tmp_path_factory.mktemp("made") / "mlflow.db"
    script = "import mlflow, sys; mlflow.set_tracking_uri(sys.argv[1]); mlflow.set_experiment('a')"
    python(script, f"sqlite:///{path}")
    return path


def truncate(path: Path) -> None:
    """Let a page in the middle be lost."""
    with path.open("r+b") as file:
        file.seek(path.stat().st_size // 2 // 4096 * 4096)
        file.write(b"\xff" * 4096)


def interrupt_transaction(path: Path) -> Path:
    """Let a writer of `path` die in mid-transaction; gives the journal that it leaves."""
    process = subprocess.run([sys.executable, "-c", KILLED, str(path)], check=False)
    assert process.returncode == -signal.SIGKILL
    return path.with_name(f"{path.name}-journal")


def experiments(path: Path) -> list[str]:
    connection = sqlite3.connect(path)
    names = connection.execute("SELECT name FROM experiments ORDER BY name").fetchall()
    connection.close()
    return [name for (name,) in names]


def leave_half_migrated(path: Path) -> None:
    """What two first connections at once leave: a table of a migration that never ended."""
    with sqlite3.connect(path) as connection:
        connection.execute("CREATE TABLE _alembic_tmp_metrics (key TEXT)")
    connection.close()


FAULTS = {
    "a page is lost": (truncate, "is damaged"),
    "half of it is lost": (lambda path: path.write_bytes(path.read_bytes()[:300_000]), "mlflow.db"),
    "no database": (lambda path: path.write_text("no database" * 100), "SQLite cannot read"),
    "empty": (lambda path: path.write_bytes(b""), "was left half made, with 0 tables"),
    "half made": (leave_half_migrated, "was left half made"),
}


def test_a_database_as_mlflow_makes_it_is_right(bare_copy: WorkingCopy, fresh_database: Path):
    shutil.copy(fresh_database, bare_copy.paths.database)
    assert bare_copy.check("database") == []


def test_no_database_is_no_fault(bare_copy: WorkingCopy):
    assert bare_copy.check("database") == []


def test_the_version_that_is_wanted_is_that_of_a_fresh_database(fresh_database: Path):
    connection = sqlite3.connect(fresh_database)
    assert connection.execute("SELECT version_num FROM alembic_version").fetchone() == (
        known_versions()[1],
    )
    connection.close()


@pytest.mark.parametrize(("corrupt", "message"), FAULTS.values(), ids=FAULTS)
def test_a_broken_database_is_found(
    bare_copy: WorkingCopy, fresh_database: Path, corrupt: Callable[[Path], None], message: str
):
    shutil.copy(fresh_database, bare_copy.paths.database)
    corrupt(bare_copy.paths.database)
    (finding,) = bare_copy.check("database")
    assert message in f"{finding.path} {finding.message}"
    assert finding.is_error


def test_a_broken_database_is_set_aside_and_made_anew(bare_copy: WorkingCopy, fresh_database: Path):
    shutil.copy(fresh_database, bare_copy.paths.database)
    truncate(bare_copy.paths.database)
    bare_copy.fix("database")
    assert bare_copy.paths.database.with_name("mlflow.db.broken").exists()


def test_a_second_broken_database_leaves_the_first_where_it_lies(
    bare_copy: WorkingCopy, fresh_database: Path
):
    first = bare_copy.paths.database.with_name("mlflow.db.broken")
    first.write_text("the only copy of some runs")
    shutil.copy(fresh_database, bare_copy.paths.database)
    truncate(bare_copy.paths.database)
    bare_copy.fix("database")
    assert first.read_text() == "the only copy of some runs"
    assert first.with_name("mlflow.db.broken2").exists()


def test_tables_of_a_newer_mlflow_stay_where_they_are(bare_copy: WorkingCopy, fresh_database: Path):
    """It is whole: what is to be changed is the MLflow that is installed."""
    shutil.copy(fresh_database, bare_copy.paths.database)
    connection = sqlite3.connect(bare_copy.paths.database)
    connection.execute("UPDATE alembic_version SET version_num = 'of_tomorrow'")
    connection.commit()
    connection.close()
    (finding,) = bare_copy.check("database")
    assert finding.is_error
    assert finding.fix == ""
    assert "which is older" in finding.message


def test_what_only_the_old_database_has_is_said_to_be_only_there(
    bare_copy: WorkingCopy, fresh_database: Path
):
    """No report on disk tells of the experiment `a`: nothing can log it anew."""
    path = bare_copy.paths.database
    shutil.copy(fresh_database, path)
    leave_half_migrated(path)
    (finding,) = bare_copy.check("database")
    assert finding.message.endswith(
        "no run is logged. From reports on disk runs are logged anew; those of reports that were "
        "overwritten since stay in mlflow.db.broken alone"
    )
    bare_copy.fix("database")
    assert "a" not in experiments(path)
    assert "a" in experiments(path.with_name("mlflow.db.broken"))


def test_a_transaction_that_was_cut_off_is_no_fault(bare_copy: WorkingCopy, fresh_database: Path):
    """To read it, SQLite must write: it rolls back by the journal.  The doctor leaves both."""
    path = bare_copy.paths.database
    shutil.copy(fresh_database, path)
    journal = interrupt_transaction(path)
    before = path.read_bytes(), journal.read_bytes()
    (finding,) = bare_copy.check("database")
    assert "a transaction was cut off" in finding.message
    assert not finding.is_error
    assert (path.read_bytes(), journal.read_bytes()) == before
    assert "a" in experiments(path)  # and that rolled it back
    assert bare_copy.check("database") == []


def test_a_broken_database_keeps_its_journal_when_it_is_set_aside(
    bare_copy: WorkingCopy, fresh_database: Path
):
    """Without it nothing takes back what the dead process wrote: the experiments would be lost."""
    path = bare_copy.paths.database
    shutil.copy(fresh_database, path)
    leave_half_migrated(path)
    interrupt_transaction(path)
    (finding,) = bare_copy.check("database")
    assert "was left half made" in finding.message
    bare_copy.fix("database")
    assert "a" in experiments(path.with_name("mlflow.db.broken"))


def test_tables_of_an_older_mlflow_are_found_behind_a_journal(bare_copy: WorkingCopy):
    python(OLDER, f"sqlite:///{bare_copy.paths.database}")
    interrupt_transaction(bare_copy.paths.database)
    (finding,) = bare_copy.check("database")
    assert f"the installed MLflow wants {known_versions()[1]}" in finding.message
    upgrade, backup = finding.fix.split(" || ")
    assert upgrade == "mlflow db upgrade sqlite:///mlflow.db"
    assert "mv mlflow.db-journal mlflow.db.broken-journal" in backup


def test_what_no_journal_mends_is_found_broken(bare_copy: WorkingCopy, fresh_database: Path):
    shutil.copy(fresh_database, bare_copy.paths.database)
    interrupt_transaction(bare_copy.paths.database)
    bare_copy.paths.database.write_text("no database" * 1000)
    bare_copy.paths.database.with_name("mlflow.db-journal").write_bytes(b"no journal")
    (finding,) = bare_copy.check("database")
    assert "SQLite cannot read" in finding.message
    assert finding.is_error


def test_a_database_that_is_in_use_is_left_alone(bare_copy: WorkingCopy, fresh_database: Path):
    shutil.copy(fresh_database, bare_copy.paths.database)
    other = sqlite3.connect(bare_copy.paths.database)
    other.execute("BEGIN EXCLUSIVE")
    (finding,) = bare_copy.check("database")
    other.close()
    assert "in use by another process" in finding.message
    assert not finding.is_error
    assert bare_copy.check("database") == []


@pytest.mark.slow
def test_tables_of_an_older_mlflow_are_brought_up_to_date(bare_copy: WorkingCopy):
    python(OLDER, f"sqlite:///{bare_copy.paths.database}")
    (finding,) = bare_copy.check("database")
    assert f"the installed MLflow wants {known_versions()[1]}" in finding.message
    bare_copy.fix("database")


@pytest.mark.slow
def test_a_migration_that_was_cut_off_is_mended_too(bare_copy: WorkingCopy, fresh_database: Path):
    """Its tables are there and its version is not: to make them once more fails."""
    shutil.copy(fresh_database, bare_copy.paths.database)
    python(BEFORE_WEBHOOKS, f"sqlite:///{bare_copy.paths.database}")
    bare_copy.fix("database")
    assert bare_copy.paths.database.with_name("mlflow.db.broken").exists()


def test_an_mlflow_that_keeps_its_migrations_elsewhere_is_said(
    bare_copy: WorkingCopy, fresh_database: Path, monkeypatch: pytest.MonkeyPatch
):
    shutil.copy(fresh_database, bare_copy.paths.database)
    monkeypatch.setattr(database, "MIGRATIONS", "elsewhere")
    (finding,) = bare_copy.check("database")
    assert "database cannot be checked" in finding.message
    assert "has no migrations in elsewhere" in finding.message
