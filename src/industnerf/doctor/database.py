"""The MLflow database: is it one, is it whole, and does the installed MLflow know its tables.

Nothing is lost with it: reports are logged anew by `python -m industnerf.tracking`.
"""

import re
import sqlite3
from importlib.util import find_spec
from pathlib import Path

from industnerf.doctor.findings import Finding
from industnerf.doctor.places import Places
from industnerf.errors import BadParams

MIGRATIONS = "store/db_migrations/versions"


def find(places: Places) -> list[Finding]:
    """At most one finding; no database is none."""
    path = places.database
    if not path.exists():
        return []
    broken = path.with_name(f"{path.name}.broken")
    replace = f"mv {places.words(path, broken)} && python -m industnerf.tracking"
    try:
        fault, version = _read(path)
    except sqlite3.Error as error:
        fault, version = f"SQLite cannot read its {path.stat().st_size} bytes: {error}", ""
    if fault:
        return [Finding(path, f"{fault}; no run is logged", replace)]
    wanted = newest_version()
    if version != wanted:
        what = f"has tables of version {version}, the installed MLflow wants {wanted}"
        upgrade = f"mlflow db upgrade sqlite:///{places.words(path)}"
        return [Finding(path, what, f"{upgrade} || ({replace})")]  # a migration may have been cut
    return []


def _read(path: Path) -> tuple[str, str]:
    """What is wrong, or an empty text; and the version of the tables."""
    connection = sqlite3.connect(f"{path.as_uri()}?mode=ro", uri=True)
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


def newest_version() -> str:
    """The last of the installed MLflow's migrations: the one that no other follows.

    Read from their text, for importing MLflow takes seconds.  Raises BadParams
    without MLflow, or if it keeps them elsewhere.
    """
    spec = find_spec("mlflow")
    if spec is None or spec.origin is None:
        raise BadParams(
            "MLflow is not installed; `python -m industnerf.doctor environment` says how"
        )
    files = (Path(spec.origin).parent / MIGRATIONS).glob("*.py")
    texts = [path.read_text() for path in files]
    versions, followed = _named(texts, "revision"), _named(texts, "down_revision")
    if not versions - followed:
        raise BadParams(f"{spec.origin} has no migrations in {MIGRATIONS} of which one is the last")
    return next(iter(versions - followed))


def _named(texts: list[str], name: str) -> set[str]:
    pattern = re.compile(rf"^{name}\s*(?::[^=]*)?=\s*[\"'](\w+)[\"']", re.MULTILINE)
    return {match[1] for text in texts if (match := pattern.search(text))}
