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
from industnerf.doctor.project_paths import ProjectPaths
from industnerf.errors import BadParams
from industnerf.runner import runner_name, worker_count
from industnerf.runner.allocation import allocation_from_environment, wait_settings_from_environment
from industnerf.runner.device import check_device

PREFIX = "INDUSTNERF_"
SIMILARITY_CUTOFF = 0.85  # of two names: all share eleven letters
SLURM_NAMES = (
    *("PARTITION", "ACCOUNT", "GRES", "CPUS", "MEMORY_MB", "MINUTES", "JOBS", "CHUNK"),
    *("PATIENCE_MIN", "POLL_S", "FOLDER"),
)
GENERAL_NAMES = ("DEBUG", "DEVICE", "MLFLOW", "ROOT", "RUNNER", "STORE", "SUMMARY", "WORKERS")
KNOWN_VARIABLES = sorted(
    PREFIX + name for name in (*GENERAL_NAMES, *(f"SLURM_{name}" for name in SLURM_NAMES))
)
# what commands ask for first; each names the variable that it refuses, and the first of several
VALIDATORS: tuple[Callable[[], object], ...] = (
    runner_name,
    worker_count,
    partial(check_device, here=False),  # whether it is there, every command asks
    allocation_from_environment,
    wait_settings_from_environment,
)


def check(paths: ProjectPaths) -> list[Finding]:
    """One finding a variable; .industnerf.env has been read by then, as by every command."""
    file_values = _read_values(paths.root / environment.FILE)
    problems = [*_unknown_variables(), *_invalid_values(), *_missing_folders()]
    return [_finding(paths.root, file_values, name, problem) for name, problem in problems]


def _read_values(file: Path) -> dict[str, str]:
    """The variables that `file` sets."""
    lines = file.read_text(encoding="utf-8").splitlines() if file.is_file() else []
    matches = [
        match for line in lines if (match := environment.LINE_PATTERN.fullmatch(line.strip()))
    ]
    return {match["name"]: match["value"].strip() for match in matches}


def _finding(root: Path, file_values: Mapping[str, str], name: str, problem: str) -> Finding:
    """In the file it has to be mended by hand; of the environment, which wins, it is taken out."""
    if file_values.get(name) == os.environ.get(name):
        return Finding(root / environment.FILE, problem, is_unfixable=True)
    return Finding(root, f"{problem} (environment)", f"unset {name}")


def _unknown_variables() -> Iterator[tuple[str, str]]:
    for name in sorted(set(os.environ) - set(KNOWN_VARIABLES)):
        if name.startswith(PREFIX):
            suggestions = get_close_matches(name, KNOWN_VARIABLES, 1, cutoff=SIMILARITY_CUTOFF)
            hint = (
                f"did you mean {suggestions[0]}?"
                if suggestions
                else f"there are {', '.join(KNOWN_VARIABLES)}"
            )
            yield name, f"{name} is no variable of the suite, and does nothing; {hint}"


def _invalid_values() -> Iterator[tuple[str, str]]:
    for validate in VALIDATORS:
        try:
            validate()
        except BadParams as error:
            yield str(error).split()[0], str(error)


def _missing_folders() -> Iterator[tuple[str, str]]:
    for name, disabled_value in ((f"{PREFIX}STORE", None), (f"{PREFIX}MLFLOW", "off")):
        value = environment.get_str(name)
        path = Path(value or ".").absolute()
        existing = next(candidate for candidate in (path, *path.parents) if candidate.exists())
        if value not in (None, disabled_value) and not existing.is_dir():
            yield name, f"{name} is {value!r}, but {existing} is no folder"
