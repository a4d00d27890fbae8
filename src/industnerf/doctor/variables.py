"""The INDUSTNERF_* variables: are there such, and can they be what they say.

One that is misspelt does nothing, and nothing says so; one that cannot be ends every command.
"""

import os
from collections.abc import Callable, Iterator, Mapping
from difflib import get_close_matches
from functools import partial
from pathlib import Path

from industnerf import environment
from industnerf.doctor.findings import Finding
from industnerf.doctor.places import Places
from industnerf.errors import BadParams
from industnerf.runner import runner_name, workers
from industnerf.runner.allocation import allocation_from_environment, waiting_from_environment
from industnerf.runner.device import check_device

PREFIX = "INDUSTNERF_"
ALIKE = 0.85  # of two names: all share eleven letters
OF_SLURM = (
    *("PARTITION", "ACCOUNT", "GRES", "CPUS", "MEMORY_MB", "MINUTES", "JOBS", "CHUNK"),
    *("PATIENCE_MIN", "POLL_S", "FOLDER"),
)
OTHERS = ("DEBUG", "DEVICE", "MLFLOW", "ROOT", "RUNNER", "STORE", "WORKERS")
KNOWN = sorted(PREFIX + name for name in (*OTHERS, *(f"SLURM_{name}" for name in OF_SLURM)))
# what commands ask for first; each names the variable that it refuses, and the first of several
ASKED: tuple[Callable[[], object], ...] = (
    runner_name,
    workers,
    partial(check_device, here=False),  # whether it is there is what `gpu` asks
    allocation_from_environment,
    waiting_from_environment,
)


def find(places: Places) -> list[Finding]:
    """One finding a variable; .industnerf.env has been read by then, as by every command."""
    said = _said_in(places.root / environment.FILE)
    faults = [*_unknown(), *_refused(), *_no_folders()]
    return [_finding(places.root, said, name, fault) for name, fault in faults]


def _said_in(file: Path) -> dict[str, str]:
    """The variables that `file` sets."""
    lines = file.read_text(encoding="utf-8").splitlines() if file.is_file() else []
    found = [match for line in lines if (match := environment.LINE.fullmatch(line.strip()))]
    return {match["name"]: match["value"].strip() for match in found}


def _finding(root: Path, said: Mapping[str, str], name: str, fault: str) -> Finding:
    """In the file it has to be mended by hand; of the environment, which wins, it is taken out."""
    if said.get(name) == os.environ.get(name):
        return Finding(root / environment.FILE, fault, wrong=True)
    return Finding(root, f"{fault} (environment)", f"unset {name}")


def _unknown() -> Iterator[tuple[str, str]]:
    for name in sorted(set(os.environ) - set(KNOWN)):
        if name.startswith(PREFIX):
            near = get_close_matches(name, KNOWN, 1, cutoff=ALIKE)
            meant = f"did you mean {near[0]}?" if near else f"there are {', '.join(KNOWN)}"
            yield name, f"{name} is no variable of the suite, and does nothing; {meant}"


def _refused() -> Iterator[tuple[str, str]]:
    for ask in ASKED:
        try:
            ask()
        except BadParams as error:
            yield str(error).split()[0], str(error)


def _no_folders() -> Iterator[tuple[str, str]]:
    for name, harmless in ((f"{PREFIX}STORE", None), (f"{PREFIX}MLFLOW", "off")):
        value = environment.text(name)
        path = Path(value or ".").absolute()
        first = next(each for each in (path, *path.parents) if each.exists())
        if value not in (None, harmless) and not first.is_dir():
            yield name, f"{name} is {value!r}, but {first} is no folder"
