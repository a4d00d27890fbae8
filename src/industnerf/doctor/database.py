"""The MLflow database: is it one, is it whole, and does the installed MLflow know its tables.

What a report on disk still says, `python -m industnerf.tracking` logs anew.  Runs of reports that
were overwritten since are in the database alone: a broken one is set aside, never removed.
"""

import re
import shutil
import sqlite3
from importlib.util import find_spec
from itertools import chain, count
from pathlib import Path
from tempfile import TemporaryDirectory

from industnerf.doctor.findings import Finding
from industnerf.doctor.project_paths import ProjectPaths
from industnerf.errors import BadParams

MIGRATIONS = "store/db_migrations/versions"
IN_USE_CODES = (sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED)
WAIT_S = 0.5  # for another process: MLflow locks the database for milliseconds


def check(paths: ProjectPaths) -> list[Finding]:
    """At most one finding; no database is none.

    Raises OSError if there is no room for the copy that `_check_rolled_back` makes, and
    BadParams as `known_versions` does.
    """
    path = paths.database
    if not path.exists():
        return []
    try:
        return _findings(paths, path)
    except sqlite3.Error as error:
        if _is_in_use(error):
            return [Finding(path, "is in use by another process; ask again when that is done")]
        if _journal(path).exists():
            return _check_rolled_back(paths)
        return [_unreadable(paths, error)]


def _is_in_use(error: sqlite3.Error) -> bool:
    """The low byte says what kind of error it is; what Python itself raises has no code."""
    return getattr(error, "sqlite_errorcode", 0) & 0xFF in IN_USE_CODES


def _journal(path: Path) -> Path:
    return path.with_name(f"{path.name}-journal")


def _check_rolled_back(paths: ProjectPaths) -> list[Finding]:
    """What is found after a process died in mid-transaction.

    By its journal SQLite takes back what it wrote, but only where it may write: here in a copy.
    """
    path = paths.database
    with TemporaryDirectory() as folder:
        copy = Path(folder, path.name)
        shutil.copyfile(path, copy)
        shutil.copyfile(_journal(path), _journal(copy))
        try:
            findings = _findings(paths, copy, mode="rw")
        except sqlite3.Error as error:
            return [_unreadable(paths, error)]
    message = (
        "a transaction was cut off; the next `make ui` rolls it back, and no earlier run is lost"
    )
    return findings or [Finding(path, message)]


def _findings(paths: ProjectPaths, database: Path, mode: str = "ro") -> list[Finding]:
    """What is wrong with the database; `database` is the file to read, a copy or itself.

    Raises sqlite3.Error if it cannot be read.
    """
    problem, version = _read_version(database, mode)
    if problem:
        return [_broken_finding(paths, problem)]
    known_migrations, required = known_versions()
    if version == required:
        return []
    message = f"has tables of version {version}, the installed MLflow wants {required}"
    if version not in known_migrations:
        message += (
            ", which is older: `python -m industnerf.doctor environment` says what to install"
        )
        return [Finding(paths.database, message, is_unfixable=True)]
    upgrade = f"mlflow db upgrade sqlite:///{paths.shell_words(paths.database)}"
    fix = f"{upgrade} || ({_backup_command(paths)})"  # a migration may have been cut
    return [Finding(paths.database, message, fix)]


def _unreadable(paths: ProjectPaths, error: sqlite3.Error) -> Finding:
    size = paths.database.stat().st_size
    return _broken_finding(paths, f"SQLite cannot read its {size} bytes: {error}")


def _broken_finding(paths: ProjectPaths, problem: str) -> Finding:
    path = paths.database
    message = (
        f"{problem}; no run is logged. From reports on disk runs are logged anew; those of reports "
        f"that were overwritten since stay in {_backup_path(path).name} alone"
    )
    return Finding(path, message, _backup_command(paths))


def _backup_path(path: Path) -> Path:
    """Where a broken database goes; not where an earlier one lies."""
    names = (f"{path.name}.broken{number}" for number in chain([""], count(2)))
    return next(backup for name in names if not (backup := path.with_name(name)).exists())


def _backup_command(paths: ProjectPaths) -> str:
    """Its journal goes with it: SQLite would delete that beside a new database."""
    path = paths.database
    backup = _backup_path(path)
    moves = [f"mv {paths.shell_words(path, backup)}"]
    if _journal(path).exists():
        moves.append(f"mv {paths.shell_words(_journal(path), _journal(backup))}")
    return " && ".join([*moves, "python -m industnerf.tracking"])


def _read_version(path: Path, mode: str) -> tuple[str, str]:
    """What is wrong, or an empty text; and the version of the tables.

    Raises sqlite3.Error if SQLite cannot read it.
    """
    connection = sqlite3.connect(f"{path.as_uri()}?mode={mode}", timeout=WAIT_S, uri=True)
    try:
        check_result = connection.execute("PRAGMA quick_check(1)").fetchone()[0]
        tables = {name for (name,) in connection.execute("SELECT name FROM sqlite_master")}
        partial_tables = sorted(name for name in tables if name.startswith("_alembic_tmp_"))
        if check_result != "ok":
            return f"is damaged: {' '.join(check_result.split())}", ""
        if "alembic_version" not in tables or partial_tables:
            return f"was left half made, with {len(tables)} tables", ""
        row = connection.execute("SELECT version_num FROM alembic_version").fetchone()
        return ("", row[0]) if row else ("has no version: was left half made", "")
    finally:
        connection.close()


def known_versions() -> tuple[set[str], str]:
    """The installed MLflow's migrations, and the last of them: the one that no other follows.

    Read from their text, for importing MLflow takes seconds.  Raises BadParams
    without MLflow, or if it keeps them elsewhere.
    """
    spec = find_spec("mlflow")
    if spec is None or spec.origin is None:
        raise BadParams(
            "MLflow is not installed; `python -m industnerf.doctor environment` says how"
        )
    files = (Path(spec.origin).parent / MIGRATIONS).glob("*.py")
    texts = [path.read_text(encoding="utf-8") for path in files]
    migrations, superseded = _revision_ids(texts, "revision"), _revision_ids(texts, "down_revision")
    if not migrations - superseded:
        raise BadParams(f"{spec.origin} has no migrations in {MIGRATIONS} of which one is the last")
    return migrations, next(iter(migrations - superseded))


def _revision_ids(texts: list[str], name: str) -> set[str]:
    pattern = re.compile(rf"^{name}\s*(?::[^=]*)?=\s*[\"'](\w+)[\"']", re.MULTILINE)
    return {match[1] for text in texts if (match := pattern.search(text))}
