"""Where a published result comes from: commit, command, machine; no name of a host and no path."""

import json
import os
import platform
from collections.abc import Mapping
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any

from industnerf import git
from industnerf.errors import BadArtifact

SCHEMA = 1
PACKAGES = ("torch", "numpy", "scipy", "POT", "warp-lang", "trimesh", "dvc")


def build_provenance(command: str) -> dict[str, Any]:
    """`made.json`: the command, the day, the commit checked out, and what differs from it.

    Raises BadArtifact outside a git repository: a published result without a commit is a rumour.
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
    """The day, and the commit as people name it: `f51e968 with changes`, or `none`."""
    try:
        commit = git.head_commit()[:7] + (" with changes" if git.changed_paths() else "")
    except BadArtifact:
        commit = "none"
    return {"schema": SCHEMA, "date": _today(), "commit": commit}


def read_provenance(folder: Path) -> dict[str, Any]:
    """What `made.json` of a result in `folder` says of it; raises BadArtifact if it is torn."""
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
    """The commit of a `made.json` as people name it."""
    return provenance["commit"][:7] + ("" if provenance.get("clean", True) else " with changes")


def describe_provenance(folder: Path) -> str:
    """Machine, day and commit of the results in the folder `published`, as documents say it."""
    provenance = read_provenance(folder)
    machine = json.loads((folder / "environment.json").read_text(encoding="utf-8"))
    return f"{machine['cores']} cores of {machine['cpu']}, {provenance['date']}, commit {commit_label(provenance)}"


def provenance_line() -> str:
    """One line for a page: the day, the commit if there is one, the machine."""
    origin, machine = commit_stamp(), environment()
    return (
        f"{origin['date']}, commit {origin['commit']}, {machine['cores']} cores of {machine['cpu']}, "
        f"Python {machine['python']}, torch {machine['packages']['torch']}"
    )


def _today() -> str:
    return datetime.now(UTC).date().isoformat()


def environment() -> dict[str, Any]:
    """`environment.json`: what the numbers and the seconds may depend on beside the commit."""
    return {
        "schema": SCHEMA,
        "python": platform.python_version(),
        "platform": " ".join(filter(None, (platform.system(), platform.machine(), _libc()))),
        "cpu": cpu_model(),
        "cores": len(os.sched_getaffinity(0)),
        "packages": {name: version(name) for name in PACKAGES},
    }


def _libc() -> str:
    return "-".join(platform.libc_ver()).strip("-")


def cpu_model(path: Path = Path("/proc/cpuinfo")) -> str:
    """As the processor calls itself, or `unknown`."""
    if path.exists():
        for line in path.read_text(encoding="utf-8").splitlines():
            name, _, value = line.partition(":")
            if name.strip() == "model name":
                return value.strip()
    return "unknown"
