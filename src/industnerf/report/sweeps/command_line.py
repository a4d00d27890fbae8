"""A sweep preset as the one line of Hydra's that asks the same, in full."""

import shlex
from pathlib import Path
from typing import Any

from industnerf.config import flatten, read_yaml

COMMAND = "python -m pipeline.sweep --multirun"
HYDRA_KEYS = ("defaults", "hydra")


def command_line_of(path: Path) -> str:
    """The line that the preset at `path` stands for: on what it builds, what it sets and sweeps.

    A line's settings win over those of files.  So where files are swept that set what the preset
    does, it has to name the preset.
    """
    preset = read_yaml(path)
    base = [f"experiment={name}" for name in preset.get("defaults", []) if name != "_self_"]
    overrides = {key: value for key, value in preset.items() if key not in HYDRA_KEYS}
    swept = preset["hydra"]["sweeper"]["params"]
    if any(set(read_yaml(file)) & set(overrides) for file in _group_files(path.parents[1], swept)):
        return f"{COMMAND} experiment={path.stem}"
    folder = {"hydra": {"sweep": preset["hydra"].get("sweep", {})}}
    values = flatten(overrides) | flatten(folder) | swept
    arguments = [*base, *(f"{key}={_hydra_text(value)}" for key, value in values.items())]
    return " ".join([COMMAND, *map(shlex.quote, arguments)])


def _group_files(conf: Path, swept: dict[str, Any]) -> list[Path]:
    """Those of the groups that are swept; what else is swept is no folder of `conf`."""
    return [file for key in swept for file in sorted((conf / key).glob("*.yaml"))]


def _hydra_text(value: Any) -> str:
    """As Hydra reads it from a command line."""
    return f"[{','.join(map(str, value))}]" if isinstance(value, list) else str(value)
