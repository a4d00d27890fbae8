"""Installed packages against constraints.txt, with which every number was made."""

import re
import shlex
import shutil
import sys
import tomllib
from importlib.metadata import PathDistribution
from pathlib import Path

from industnerf.doctor.findings import Finding
from industnerf.doctor.places import Places

PIN = re.compile(r"([\w.-]+)==([^\s;]+)")


def find(places: Places) -> list[Finding]:
    """Installs that were cut off; in one more, other versions and dependencies that are missing."""
    pinned = pins((places.root / "constraints.txt").read_text(encoding="utf-8"))
    torn = {path: plain(path.name.partition("-")[0]) for path in _torn()}
    found = [_cut_off(places, path, name, name in pinned) for path, name in torn.items()]
    installed = _installed()
    other = {n: v for n, v in installed.items() if n in pinned and v not in pinned[n]}
    missing = [n for n in _required(places.root) if n not in {*installed, *torn.values()}]
    said = [f"{name} is {v}, not {' or '.join(pinned[name])}" for name, v in other.items()]
    said += [f"{name} is missing" for name in missing]
    mend = f"{_installer()} {shlex.join([*other, *missing])}"
    return found + ([Finding(Path(sys.prefix), "; ".join(said), mend)] if said else [])


def _installed() -> dict[str, str]:
    """Name -> version, of what says both; of two of a name the one that Python finds first."""
    whole = [PathDistribution(path) for path in _folders() if _is_whole(path)]
    return {plain(one.metadata["Name"]): one.version.partition("+")[0] for one in whole[::-1]}


def _folders() -> list[Path]:
    return [path for at in dict.fromkeys(sys.path) for path in Path(at).glob("*.dist-info")]


def _is_whole(folder: Path) -> bool:
    """Not what does not say its name and version, nor what pip had put aside as `~orch`."""
    try:
        said = PathDistribution(folder).metadata
    except UnicodeDecodeError:  # cut within a letter
        return False
    return not folder.name.startswith("~") and all(said.get(key) for key in ("Name", "Version"))


def _torn() -> list[Path]:
    """What an install that was cut off left."""
    return sorted(path for path in _folders() if not _is_whole(path))


def _cut_off(places: Places, path: Path, name: str, is_pinned: bool) -> Finding:
    """What is not pinned only goes: pip cannot install a name such as `~orch`, which it left."""
    what = "is no whole package with a name and a version: an install was cut off"
    remove = f"rm -rf {places.words(path)}"
    return Finding(path, what, f"{remove} && {_installer()} {name}" if is_pinned else remove)


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
    project = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    return [plain(re.split(r"[^\w.-]", line)[0]) for line in project["dependencies"]]


def _installer() -> str:
    """The command that installs for this interpreter what constraints.txt says.

    An environment that uv made has no pip.
    """
    python = shlex.quote(sys.executable)
    if shutil.which("uv"):
        return f"uv pip install --python {python} -c constraints.txt"
    return f"{python} -m pip install -c constraints.txt"
