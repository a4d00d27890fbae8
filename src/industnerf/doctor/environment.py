"""Installed packages against constraints.txt, with which every number was made."""

import re
import shlex
import shutil
import sys
import tomllib
from importlib.metadata import PathDistribution
from pathlib import Path

from industnerf.doctor.findings import Finding
from industnerf.doctor.project_paths import ProjectPaths

PIN = re.compile(r"([\w.-]+)==([^\s;]+)")


def check(paths: ProjectPaths) -> list[Finding]:
    """Installs that were cut off; in one more, other versions and dependencies that are missing."""
    pinned = parse_pins((paths.root / "constraints.txt").read_text(encoding="utf-8"))
    truncated = {
        path: normalize_name(path.name.partition("-")[0]) for path in _truncated_installs()
    }
    findings = [
        _truncated_finding(paths, path, name, name in pinned) for path, name in truncated.items()
    ]
    installed = _installed_versions()
    mismatched = {n: v for n, v in installed.items() if n in pinned and v not in pinned[n]}
    missing = [n for n in _required_names(paths.root) if n not in {*installed, *truncated.values()}]
    messages = [f"{name} is {v}, not {' or '.join(pinned[name])}" for name, v in mismatched.items()]
    messages += [f"{name} is missing" for name in missing]
    fix = f"{_install_command()} {shlex.join([*mismatched, *missing])}"
    return findings + ([Finding(Path(sys.prefix), "; ".join(messages), fix)] if messages else [])


def _installed_versions() -> dict[str, str]:
    """Name -> version, of what says both; of two of a name the one that Python finds first."""
    distributions = [PathDistribution(path) for path in _dist_info_folders() if _is_intact(path)]
    return {
        normalize_name(distribution.metadata["Name"]): distribution.version.partition("+")[0]
        for distribution in distributions[::-1]
    }


def _dist_info_folders() -> list[Path]:
    return [path for entry in dict.fromkeys(sys.path) for path in Path(entry).glob("*.dist-info")]


def _is_intact(folder: Path) -> bool:
    """Not what does not say its name and version, nor what pip had put aside as `~orch`."""
    try:
        metadata = PathDistribution(folder).metadata
    except UnicodeDecodeError:  # cut within a letter
        return False
    return not folder.name.startswith("~") and all(metadata.get(key) for key in ("Name", "Version"))


def _truncated_installs() -> list[Path]:
    """What an install that was cut off left."""
    return sorted(path for path in _dist_info_folders() if not _is_intact(path))


def _truncated_finding(paths: ProjectPaths, path: Path, name: str, is_pinned: bool) -> Finding:
    """What is not pinned only goes: pip cannot install a name such as `~orch`, which it left."""
    message = "is no whole package with a name and a version: an install was cut off"
    remove = f"rm -rf {paths.shell_words(path)}"
    return Finding(
        path, message, f"{remove} && {_install_command()} {name}" if is_pinned else remove
    )


def parse_pins(text: str) -> dict[str, list[str]]:
    """Name -> versions: several where they depend on the Python."""
    versions: dict[str, list[str]] = {}
    for name, version in PIN.findall(text):
        versions.setdefault(normalize_name(name), []).append(version)
    return versions


def normalize_name(name: str) -> str:
    """`Py_YAML` and `py-yaml` are one package."""
    return re.sub(r"[-_.]+", "-", name).lower()


def _required_names(root: Path) -> list[str]:
    """The dependencies that pyproject.toml names."""
    project = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    return [normalize_name(re.split(r"[^\w.-]", line)[0]) for line in project["dependencies"]]


def _install_command() -> str:
    """The command that installs for this interpreter what constraints.txt says.

    An environment that uv made has no pip.
    """
    python = shlex.quote(sys.executable)
    if shutil.which("uv"):
        return f"uv pip install --python {python} -c constraints.txt"
    return f"{python} -m pip install -c constraints.txt"
