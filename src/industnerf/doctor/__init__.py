"""What is wrong with this working copy, and what mends it: `python -m industnerf.doctor`.

A check is a module with one function, `check(paths) -> list[Finding]`.  It reads and changes
nothing.
"""

from importlib import import_module

from industnerf.doctor.findings import Finding
from industnerf.doctor.project_paths import ProjectPaths
from industnerf.errors import BadParams, SuiteError

CHECKS = {
    "cache": "DVC's cache: does each file hold what its name promises",
    "lockfile": "dvc.lock: is it whole, and of this dvc.yaml",
    "locks": "locks that a dead, stopped or foreign process holds",
    "stale_files": "what killed processes left behind in the store and the cache",
    "store": "results in the store: whole, read-only, with their costs",
    "database": "the MLflow database: readable, and of the installed version",
    "environment": "installed packages against constraints.txt",
    "variables": "INDUSTNERF_*: known, and of values that commands take",
}
ON_REQUEST = {  # takes longer, so only by name
    "reproducible": "does this machine give the published bytes; trains for half a minute",
}


def run_check(name: str, paths: ProjectPaths) -> list[Finding]:
    """What the check `name` finds; a check that cannot be made is a finding too.

    Raises BadParams that lists the known checks.
    """
    known = CHECKS | ON_REQUEST
    if name not in known:
        raise BadParams(f"check {name!r} is unknown, known are {', '.join(known)}")
    try:
        return import_module(f"industnerf.doctor.{name}").check(paths)
    except (SuiteError, OSError) as error:
        return [Finding(paths.root, f"{name} cannot be checked: {error}", is_unfixable=True)]
