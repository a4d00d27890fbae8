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
from industnerf.doctor.places import Places
from industnerf.errors import BadParams

MIGRATIONS = "store/db_migrations/versions"
IN_USE = (sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED)
WAIT_S = 0.5  # for another process: MLflow locks the database for milliseconds


def find(places: Places) -> list[Finding]:
    """At most one finding; no database is none.

    Raises OSError if there is no room for the copy that `_rolled_back` makes, and BadParams as
    `versions` does.
    """
    path = places.database
    if not path.exists():
        return []
    try:
        return _findings(places, path)
    except sqlite3.Error as error:
        if _is_in_use(error):
            return [Finding(path, "is in use by another process; ask again when that is done")]
        if _journal(path).exists():
            return _rolled_back(places)
        return [_unreadable(places, error)]


def _is_in_use(error: sqlite3.Error) -> bool:
    """The low byte says what kind of error it is; what Python itself raises has no code."""
    return getattr(error, "sqlite_errorcode", 0) & 0xFF in IN_USE


def _journal(path: Path) -> Path:
    return path.with_name(f"{path.name}-journal")


def _rolled_back(places: Places) -> list[Finding]:
    """What is found after a process died in mid-transaction.

    By its journal SQLite takes back what it wrote, but only where it may write: here in a copy.
    """
    path = places.database
    with TemporaryDirectory() as folder:
        copy = Path(folder, path.name)
        shutil.copyfile(path, copy)
        shutil.copyfile(_journal(path), _journal(copy))
        try:
            found = _findings(places, copy, mode="rw")
        except sqlite3.Error as error:
            return [_unreadable(places, error)]
    what = "a transaction was cut off; the next `make ui` rolls it back, and no earlier run is lost"
    return found or [Finding(path, what)]


def _findings(places: Places, read: Path, mode: str = "ro") -> list[Finding]:
    """What is wrong with the database, of which `read` is a copy or itself.

    Raises sqlite3.Error if it cannot be read.
    """
    fault, version = _read(read, mode)
    if fault:
        return [_broken(places, fault)]
    known, wanted = versions()
    if version == wanted:
        return []
    what = f"has tables of version {version}, the installed MLflow wants {wanted}"
    if version not in known:
        what += ", which is older: `python -m industnerf.doctor environment` says what to install"
        return [Finding(places.database, what, wrong=True)]
    upgrade = f"mlflow db upgrade sqlite:///{places.words(places.database)}"
    mend = f"{upgrade} || ({_set_aside(places)})"  # a migration may have been cut
    return [Finding(places.database, what, mend)]


def _unreadable(places: Places, error: sqlite3.Error) -> Finding:
    size = places.database.stat().st_size
    return _broken(places, f"SQLite cannot read its {size} bytes: {error}")


def _broken(places: Places, fault: str) -> Finding:
    path = places.database
    what = (
        f"{fault}; no run is logged. From reports on disk runs are logged anew; those of reports "
        f"that were overwritten since stay in {_aside(path).name} alone"
    )
    return Finding(path, what, _set_aside(places))


def _aside(path: Path) -> Path:
    """Where a broken database goes; not where an earlier one lies."""
    names = (f"{path.name}.broken{number}" for number in chain([""], count(2)))
    return next(place for name in names if not (place := path.with_name(name)).exists())


def _set_aside(places: Places) -> str:
    """Its journal goes with it: SQLite would delete that beside a new database."""
    path = places.database
    aside = _aside(path)
    moves = [f"mv {places.words(path, aside)}"]
    if _journal(path).exists():
        moves.append(f"mv {places.words(_journal(path), _journal(aside))}")
    return " && ".join([*moves, "python -m industnerf.tracking"])


def _read(path: Path, mode: str) -> tuple[str, str]:
    """What is wrong, or an empty text; and the version of the tables.

    Raises sqlite3.Error if SQLite cannot read it.
    """
    connection = sqlite3.connect(f"{path.as_uri()}?mode={mode}", timeout=WAIT_S, uri=True)
    try:
        verdict = connection.execute("PRAGMA quick_check(1)").fetchone()[0]
        tables = {name for (name,) in connection.execute("SELECT name FROM sqlite_master")}
        half = sorted(name for name in tables if name.startswith("_alembic_tmp_"))
        if verdict != "ok":
            return f"is damaged: {' '.join(verdict.split())}", ""
        if "alembic_version" not in tables or half:
            return f"was left half made, with {len(tables)} tables", ""
        found = connection.execute("SELECT version_num FROM alembic_version").fetchone()
        return ("", found[0]) if found else ("has no version: was left half made", "")
    finally:
        connection.close()


def versions() -> tuple[set[str], str]:
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
    known, followed = _named(texts, "revision"), _named(texts, "down_revision")
    if not known - followed:
        raise BadParams(f"{spec.origin} has no migrations in {MIGRATIONS} of which one is the last")
    return known, next(iter(known - followed))


def _named(texts: list[str], name: str) -> set[str]:
    pattern = re.compile(rf"^{name}\s*(?::[^=]*)?=\s*[\"'](\w+)[\"']", re.MULTILINE)
    return {match[1] for text in texts if (match := pattern.search(text))}
