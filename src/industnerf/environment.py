"""How and where to execute: INDUSTNERF_* variables, from the environment or .industnerf.env.

A checkout beside the main one, such as those in which DVC runs queued experiments, has the main
one's file, store and database: git leaves them out of it. So has the project of a preset in
runs/, whose dvc.yaml is a link to the one two folders up.

Never part of params.yaml: none of them changes a result by more than the rounding of a GPU, so
none may cause a rerun.  (Over a training roundings grow: benchmarks/results.md has what another
device does.)  The file is for one machine and one person, git does not see it, and
the environment wins over it:

    # .industnerf.env
    INDUSTNERF_RUNNER=submitit
    INDUSTNERF_SLURM_PARTITION=cpu
"""

import os
import re
from pathlib import Path

from industnerf.errors import BadParams

FILE = Path(".industnerf.env")
LINK_OF_PRESETS = "../../dvc.yaml"  # from runs/<preset>
DVC_EXPERIMENTS = (".dvc", "tmp", "exps")  # where DVC makes its temporary checkouts
LINE_PATTERN = re.compile(r"(?P<name>(INDUSTNERF|SBATCH)_[A-Z0-9_]+)=(?P<value>.*)")


def main_checkout(folder: Path = Path()) -> Path:
    """The checkout that owns `folder`: of a temporary one of DVC, a git worktree, or a preset's
    project, the main one.

    `folder` itself, as an absolute path, where it is no such checkout.
    """
    own = folder.absolute()
    for start in range(len(own.parts) - len(DVC_EXPERIMENTS)):
        if own.parts[start : start + len(DVC_EXPERIMENTS)] == DVC_EXPERIMENTS:
            return Path(*own.parts[:start])
    pipeline = own / "dvc.yaml"
    if pipeline.is_symlink() and os.readlink(pipeline) == LINK_OF_PRESETS:
        return main_checkout(own.parents[1])
    pointer = own / ".git"  # of a worktree a file: "gitdir: <common directory>/worktrees/<name>"
    if pointer.is_file():
        git_dir = own / pointer.read_text(encoding="utf-8").removeprefix("gitdir:").strip()
        if git_dir.parent.name == "worktrees":
            return git_dir.parent.parent.parent.resolve()
    return own


def read_local_file(path: Path | None = None) -> None:
    """Take over what `path`, if it is there, says of variables that are not set.

    By default it is the file of the main checkout.

    Raises BadParams for a line that is no `NAME=value` of a name in INDUSTNERF_* or SBATCH_*.
    """
    path = main_checkout() / FILE if path is None else path
    lines = path.read_text(encoding="utf-8").splitlines() if path.is_file() else []
    for line_number, line in enumerate(lines, start=1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        match = LINE_PATTERN.fullmatch(line.strip())
        if match is None:
            raise BadParams(
                f"{path}:{line_number}: {line.strip()!r} is no NAME=value "
                "of a name that begins with INDUSTNERF_ or SBATCH_"
            )
        os.environ.setdefault(match["name"], match["value"].strip())


def get_str(name: str) -> str | None:
    """The variable `name`, or None where it is not set or empty."""
    return os.environ.get(name) or None


def get_positive_int(name: str, unit: str, default: int | None = None) -> int | None:
    """The variable `name` as a whole number of `unit`, at least 1.

    Raises BadParams for anything else.
    """
    value = get_str(name)
    if value is None:
        return default
    if not (value.isascii() and value.isdigit()) or int(value) < 1:
        raise BadParams(f"{name} is {value!r}, must be a number of {unit}, at least 1")
    return int(value)
