"""Does a dvc.lock belong to the dvc.yaml and params.yaml beside it?  As far as no data can tell."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from industnerf.config import Stage, load_stages, read_yaml


def lock_mismatches(folder: Path, name: str = "dvc") -> list[str]:
    """What `dvc.lock` has otherwise: stages, commands, parameters, files of several stages.

    `name` is what it and `dvc.yaml` are called in `folder`.
    """
    locked, params = read_yaml(folder / f"{name}.lock")["stages"], read_yaml(folder / "params.yaml")
    declared = dict(_declared(folder / f"{name}.yaml", params["methods"]))
    mismatches = [f"{name}: in one file alone" for name in sorted(declared.keys() ^ locked.keys())]
    for name in declared.keys() & locked.keys():
        stage_spec, entry = declared[name], locked[name]
        if entry["cmd"] != _interpolate(stage_spec.command, params):
            mismatches.append(f"{name}: ran {entry['cmd']}")
        for kind, paths in (("deps", stage_spec.deps), ("outs", stage_spec.outs)):
            if {item["path"] for item in entry[kind]} != {
                _interpolate(path, params) for path in paths
            }:
                mismatches.append(f"{name}: other {kind}")
        expected = {key: _value(params, key) for key in stage_spec.params}
        used = entry.get("params", {}).get("params.yaml", {})
        mismatches += [
            f"{name}: ran with {key} {used.get(key)}"
            for key in sorted(expected.keys() | used.keys())
            if expected.get(key) != used.get(key)
        ]
    return mismatches + _inconsistent_files(locked)


def _declared(path: Path, methods: list[str]) -> Iterator[tuple[str, Stage]]:
    """Every stage of dvc.yaml by its name in dvc.lock.

    Of a matrix, as published studies of older code have, one for each method.
    """
    for name, raw in load_stages(path).items():
        items = raw.get("matrix", {"method": [None]})["method"]
        for item in methods if items == "${methods}" else items:
            command, params, deps, outs = (
                [text.replace("${item.method}", item or "") for text in texts]
                for texts in (
                    [raw["cmd"]],
                    *(raw.get(key, []) for key in ("params", "deps", "outs")),
                )
            )
            stage = Stage(name, command[0], tuple(params), tuple(deps), tuple(outs))
            yield f"{name}@{item}" if item else name, stage


def _interpolate(text: str, params: dict[str, Any]) -> str:
    return re.sub(r"\$\{([\w.]+)\}", lambda match: str(_value(params, match[1])), text)


def _value(params: Any, key: str) -> Any:
    for name in key.split("."):
        params = params[name]
    return params


def _inconsistent_files(locked: dict[str, Any]) -> list[str]:
    """Files that were in one state in one stage and in another in the next."""
    digests: dict[str, str] = {}
    mismatches = []
    for name, entry in locked.items():
        for item in [*entry["deps"], *entry["outs"]]:
            if digests.setdefault(item["path"], item["md5"]) != item["md5"]:
                mismatches.append(f"{name}: another {item['path']}")
    return mismatches
