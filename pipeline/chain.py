"""All stages of dvc.yaml in one process, below one folder: what a point of a sweep runs."""

import re
import shlex
from importlib import import_module
from pathlib import Path
from typing import Any

from industnerf import config
from industnerf.schema import Params


def run_chain(params: Params, folder: Path) -> None:
    """Run every stage in the order of dvc.yaml, with every output below `folder`.

    dvc.yaml stays the only place that knows the wiring: its commands are taken apart, and what
    any stage writes is moved below `folder`.
    """
    stages = [
        config.stage(name, method)
        for name in config.load_stages()
        for method in (params.methods if config.is_matrix(name) else [None])
    ]
    outs = {out for stage in stages for out in stage.outs}
    for stage in stages:
        module, *arguments = shlex.split(stage.command.removeprefix("python -m "))
        placed = [_place(_filled(text, params), outs, folder) for text in arguments]
        import_module(module).main(stage.mask(params), *placed)


def _filled(text: str, params: Params) -> str:
    """`text` with `${a.b}` replaced by that parameter."""

    def value(match: re.Match[str]) -> str:
        found: Any = params
        for name in match[1].split("."):
            found = getattr(found, name)
        return str(found)

    return re.sub(r"\$\{([\w.]+)\}", value, text)


def _place(text: str, outs: set[str], folder: Path) -> str:
    """`text` below `folder` if some stage writes it, or a folder or file in it."""
    written = any(out == text or out.startswith(f"{text}/") for out in outs)
    return str(folder / text) if written else text
