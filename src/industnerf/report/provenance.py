"""Where a published result comes from: commit, command, machine; no name of a host and no path."""

import json
import os
import platform
import subprocess
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any

from industnerf.errors import BadArtifact

PACKAGES = ("torch", "numpy", "scipy", "POT", "warp-lang", "trimesh", "dvc")
# Written after a result is made; no score depends on them (the page shows results/grid, seeds).
LATER = ("dvc.lock", "results", "README.md", "docs")


def made_by(command: str) -> dict[str, Any]:
    """`made.json`: the command, the day, the commit checked out, and what differs from it.

    Raises BadArtifact outside a git repository: a published result without a commit is a rumour.
    """
    changed = _git("status", "--porcelain", "--", ".", *(f":!{path}" for path in LATER))
    return {
        "schema": 1,
        "command": command,
        "date": _today(),
        "commit": _git("rev-parse", "HEAD").strip(),
        "clean": not changed,
        "changed": [line[3:] for line in changed.splitlines()],
    }


def origin() -> dict[str, Any]:
    """The day, and the commit as people name it: `f51e968 with changes`, or `none`."""
    try:
        changed = _git("status", "--porcelain", "--", ":/", *(f":(top,exclude){p}" for p in LATER))
        commit = _git("rev-parse", "HEAD")[:7] + (" with changes" if changed else "")
    except BadArtifact:
        commit = "none"
    return {"schema": 1, "date": _today(), "commit": commit}


def made_where(published: Path) -> str:
    """Machine, day and commit of the results in the folder `published`, as documents say it."""
    made = json.loads((published / "made.json").read_text())
    machine = json.loads((published / "environment.json").read_text())
    return (
        f"{machine['cores']} cores of {machine['cpu']}, {made['date']}, commit "
        f"{made['commit'][:7]}{'' if made['clean'] else ' with changes'}"
    )


def stamp() -> str:
    """One line for a page: the day, the commit if there is one, the machine."""
    made, machine = origin(), environment()
    return (
        f"{made['date']}, commit {made['commit']}, {machine['cores']} cores of {machine['cpu']}, "
        f"Python {machine['python']}, torch {machine['packages']['torch']}"
    )


def _today() -> str:
    return datetime.now(UTC).date().isoformat()


def _git(*arguments: str) -> str:
    try:
        done = subprocess.run(["git", *arguments], capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError) as error:
        raise BadArtifact(f"no commit to publish under: git {arguments[0]}: {error}") from None
    return done.stdout


def environment() -> dict[str, Any]:
    """`environment.json`: what the numbers and the seconds may depend on beside the commit."""
    return {
        "schema": 1,
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
        for line in path.read_text().splitlines():
            name, _, value = line.partition(":")
            if name.strip() == "model name":
                return value.strip()
    return "unknown"
