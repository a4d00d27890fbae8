"""Provenance of a published result: commit, command, machine; no host name, no path."""

import json
import os
import platform
from collections.abc import Mapping
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any

from industnerf import git, processor
from industnerf.errors import BadArtifact

SCHEMA = 1
PACKAGES = ("torch", "numpy", "scipy", "POT", "warp-lang", "trimesh", "dvc")


def build_provenance(command: str) -> dict[str, Any]:
    """`made.json`: command, day, commit, and the files that differ from it.

    Raises BadArtifact outside a git repository.
    """
    changed = git.changed_paths()
    return {
        "schema": SCHEMA,
        "command": command,
        "date": _today(),
        "commit": git.head_commit(),
        "clean": not changed,
        "changed": changed,
    }


def commit_stamp() -> dict[str, Any]:
    """The day and the short commit, such as `f51e968 with changes`; `none` outside a repository."""
    try:
        commit = git.head_commit()[:7] + (" with changes" if git.changed_paths() else "")
    except BadArtifact:
        commit = "none"
    return {"schema": SCHEMA, "date": _today(), "commit": commit}


def read_provenance(folder: Path) -> dict[str, Any]:
    """The `made.json` of the result in `folder`; raises BadArtifact if it is missing or torn."""
    path = folder / "made.json"
    try:
        provenance = json.loads(path.read_text(encoding="utf-8"))
        if provenance["schema"] != SCHEMA:
            raise ValueError(f"its schema is {provenance['schema']}, this code reads {SCHEMA}")
        return provenance
    except (OSError, ValueError, TypeError, KeyError) as error:
        raise BadArtifact(
            f"{path} cannot be read ({error}); what makes {folder} writes it"
        ) from None


def commit_label(provenance: Mapping[str, Any]) -> str:
    """The short commit of a `made.json`."""
    return provenance["commit"][:7] + ("" if provenance.get("clean", True) else " with changes")


def describe_provenance(folder: Path) -> str:
    """Machine, day and commit of the results in `folder`, in one phrase."""
    provenance = read_provenance(folder)
    machine = json.loads((folder / "environment.json").read_text(encoding="utf-8"))
    commit = commit_label(provenance)
    return f"{machine['cores']} cores of {machine['cpu']}, {provenance['date']}, commit {commit}"


def provenance_line() -> str:
    """One line for a page: the day, the commit if there is one, the machine."""
    origin, machine = commit_stamp(), environment()
    return (
        f"{origin['date']}, commit {origin['commit']}, "
        f"{machine['cores']} cores of {machine['cpu']}, Python {machine['python']}, "
        f"torch {machine['packages']['torch']}"
    )


def _today() -> str:
    return datetime.now(UTC).date().isoformat()


def environment() -> dict[str, Any]:
    """`environment.json`: machine and versions."""
    return {
        "schema": SCHEMA,
        "python": platform.python_version(),
        "platform": " ".join(filter(None, (platform.system(), platform.machine(), _libc()))),
        "cpu": processor.model(),
        "cores": len(os.sched_getaffinity(0)),
        "packages": {name: version(name) for name in PACKAGES},
    }


def _libc() -> str:
    return "-".join(platform.libc_ver()).strip("-")
