"""A sweep preset as the one line of Hydra's that asks the same, in full."""

import shlex
from pathlib import Path
from typing import Any

from industnerf.config import flat, read_yaml

COMMAND = "python -m pipeline.sweep --multirun"
OWN = ("defaults", "hydra")


def line_of(path: Path) -> str:
    """The line that the preset at `path` stands for: on what it builds, what it sets and sweeps."""
    preset = read_yaml(path)
    base = [f"experiment={name}" for name in preset.get("defaults", []) if name != "_self_"]
    set_to = {key: value for key, value in preset.items() if key not in OWN}
    swept = preset["hydra"]["sweeper"]["params"]
    words = [*base, *(f"{key}={_text(value)}" for key, value in (flat(set_to) | swept).items())]
    return " ".join([COMMAND, *map(shlex.quote, words)])


def _text(value: Any) -> str:
    """As Hydra reads it from a command line."""
    return f"[{','.join(map(str, value))}]" if isinstance(value, list) else str(value)
