"""All stages of dvc.yaml in one process, below one folder: what a point of a sweep runs."""

import re
import shlex
from importlib import import_module
from pathlib import Path
from typing import Any

from industnerf import config
from industnerf.schema import Params


def run_pipeline(params: Params, folder: Path) -> None:
    """Run every stage in the order of dvc.yaml, with every output below `folder`.

    dvc.yaml stays the only place that knows the wiring: its commands are taken apart, and what
    any stage writes is moved below `folder`.
    """
    stages = [config.load_stage(name) for name in config.load_stages()]
    outs = {out for stage in stages for out in stage.outs}
    for stage in stages:
        module, *arguments = shlex.split(stage.command.removeprefix("python -m "))
        resolved = [_output_path(_interpolate(text, params), outs, folder) for text in arguments]
        import_module(module).main(stage.select_params(params), *resolved)


def _interpolate(text: str, params: Params) -> str:
    """`text` with `${a.b}` replaced by that parameter."""

    def value(match: re.Match[str]) -> str:
        value_at: Any = params
        for name in match[1].split("."):
            value_at = getattr(value_at, name)
        return str(value_at)

    return re.sub(r"\$\{([\w.]+)\}", value, text)


def _output_path(text: str, outs: set[str], folder: Path) -> str:
    """`text` below `folder` if some stage writes it, or a folder or file in it."""
    is_output = any(out == text or out.startswith(f"{text}/") for out in outs)
    return str(folder / text) if is_output else text
