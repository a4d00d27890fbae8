"""The INDUSTNERF_* variables: are there such, and can they be what they say.

One that is misspelt does nothing, and nothing says so; one that cannot be ends every command.
"""

import os
from collections.abc import Iterator
from difflib import get_close_matches
from pathlib import Path

from industnerf import environment
from industnerf.doctor.findings import Finding
from industnerf.doctor.places import Places
from industnerf.errors import BadParams
from industnerf.runner.device import check_device

PREFIX = "INDUSTNERF_"
ALIKE = 0.85  # of two names: all share eleven letters
RUNNERS = ("process", "serial", "submitit")
FOLDERS = ("STORE", "MLFLOW")
NUMBERS = {
    "WORKERS": "processes",
    "SLURM_CPUS": "cores",
    "SLURM_MEMORY_MB": "MB",
    "SLURM_MINUTES": "minutes",
    "SLURM_JOBS": "jobs",
    "SLURM_CHUNK": "pieces of work",
    "SLURM_PATIENCE_MIN": "minutes",
    "SLURM_POLL_S": "seconds",
}
TEXTS = ("DEVICE", "RUNNER", "ROOT", "DEBUG")
TEXTS_OF_SLURM = ("SLURM_PARTITION", "SLURM_ACCOUNT", "SLURM_GRES", "SLURM_FOLDER")
KNOWN = sorted(PREFIX + name for name in (*FOLDERS, *NUMBERS, *TEXTS, *TEXTS_OF_SLURM))


def find(places: Places) -> list[Finding]:
    """One finding a variable; .industnerf.env has been read by then, as by every command."""
    where = places.root / environment.FILE
    faults = [*_unknown(), *_refused(), *_no_folders()]
    return [_finding(where, name, fault) for name, fault in faults]


def _finding(file: Path, name: str, fault: str) -> Finding:
    """In the file it has to be mended by hand; of the environment it can be taken out."""
    if file.is_file() and name in file.read_text():
        return Finding(file, fault, wrong=True)
    return Finding(file.parent, f"{fault} (environment)", f"unset {name}")


def _unknown() -> Iterator[tuple[str, str]]:
    for name in sorted(set(os.environ) - set(KNOWN)):
        if name.startswith(PREFIX):
            near = get_close_matches(name, KNOWN, 1, cutoff=ALIKE)
            meant = f"did you mean {near[0]}?" if near else f"there are {', '.join(KNOWN)}"
            yield name, f"{name} is no variable of the suite, and does nothing; {meant}"


def _refused() -> Iterator[tuple[str, str]]:
    """What the commands themselves would say."""
    for name, what in NUMBERS.items():
        try:
            environment.number(PREFIX + name, what)
        except BadParams as error:
            yield PREFIX + name, str(error)
    try:
        check_device(here=False)  # whether it is there is what `gpu` asks
    except BadParams as error:
        yield f"{PREFIX}DEVICE", str(error)
    runner = environment.text(f"{PREFIX}RUNNER")
    if runner not in (None, *RUNNERS):
        known = ", ".join(RUNNERS)
        yield f"{PREFIX}RUNNER", f"{PREFIX}RUNNER is {runner!r}, must be one of {known}"


def _no_folders() -> Iterator[tuple[str, str]]:
    for name in (PREFIX + folder for folder in FOLDERS):
        value = environment.text(name)
        path = Path(value or ".").absolute()
        first = next(each for each in (path, *path.parents) if each.exists())
        if value and value != "off" and not first.is_dir():
            yield name, f"{name} is {value!r}, but {first} is no folder"
