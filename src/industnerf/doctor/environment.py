"""Installed packages against constraints.txt, with which every number was made."""

import re
import shlex
import shutil
import sys
import tomllib
from importlib.metadata import distributions
from pathlib import Path

from industnerf.doctor.findings import Finding
from industnerf.doctor.places import Places

PIN = re.compile(r"([\w.-]+)==([^\s;]+)")


def find(places: Places) -> list[Finding]:
    """At most one finding: packages of another version, and dependencies that are missing."""
    pinned = pins((places.root / "constraints.txt").read_text())
    installed = {
        plain(found.metadata["Name"]): found.version.partition("+")[0] for found in distributions()
    }
    other = {n: v for n, v in installed.items() if n in pinned and v not in pinned[n]}
    missing = [n for n in _required(places.root) if n not in installed]
    said = [f"{name} is {v}, not {' or '.join(pinned[name])}" for name, v in other.items()]
    said += [f"{name} is missing" for name in missing]
    mend = f"{_installer()} {shlex.join([*other, *missing])}"
    return [Finding(Path(sys.prefix), "; ".join(said), mend)] if said else []


def pins(text: str) -> dict[str, list[str]]:
    """Name -> versions: several where they depend on the Python."""
    found: dict[str, list[str]] = {}
    for name, version in PIN.findall(text):
        found.setdefault(plain(name), []).append(version)
    return found


def plain(name: str) -> str:
    """`Py_YAML` and `py-yaml` are one package."""
    return re.sub(r"[-_.]+", "-", name).lower()


def _required(root: Path) -> list[str]:
    """The dependencies that pyproject.toml names."""
    project = tomllib.loads((root / "pyproject.toml").read_text())["project"]
    return [plain(re.split(r"[^\w.-]", line)[0]) for line in project["dependencies"]]


def _installer() -> str:
    """The command that installs for this interpreter what constraints.txt says.

    An environment that uv made has no pip.
    """
    python = shlex.quote(sys.executable)
    if shutil.which("uv"):
        return f"uv pip install --python {python} -c constraints.txt"
    return f"{python} -m pip install -c constraints.txt"
