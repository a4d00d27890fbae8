"""Does a dvc.lock belong to the dvc.yaml and params.yaml beside it?  As far as no data can tell."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from industnerf.config import is_matrix, load_stages, read_yaml, stage


def lock_disagreements(folder: Path, name: str = "dvc") -> list[str]:
    """What `dvc.lock` has otherwise: stages, commands, parameters, files of several stages.

    `name` is what it and `dvc.yaml` are called in `folder`.
    """
    locked, params = read_yaml(folder / f"{name}.lock")["stages"], read_yaml(folder / "params.yaml")
    declared = dict(_declared(folder / f"{name}.yaml", params["methods"]))
    found = [f"{name}: in one file alone" for name in sorted(declared.keys() ^ locked.keys())]
    for name in declared.keys() & locked.keys():
        one, entry = declared[name], locked[name]
        if entry["cmd"] != _filled(one.command, params):
            found.append(f"{name}: ran {entry['cmd']}")
        for kind, paths in (("deps", one.deps), ("outs", one.outs)):
            if {each["path"] for each in entry[kind]} != {_filled(path, params) for path in paths}:
                found.append(f"{name}: other {kind}")
        wanted = {key: _value(params, key) for key in one.params}
        used = entry.get("params", {}).get("params.yaml", {})
        found += [
            f"{name}: ran with {key} {used.get(key)}"
            for key in sorted(wanted.keys() | used.keys())
            if wanted.get(key) != used.get(key)
        ]
    return found + _torn(locked)


def _declared(path: Path, methods: list[str]) -> Iterator[tuple[str, Any]]:
    """Every stage of dvc.yaml, one of a matrix for each method, by its name in dvc.lock."""
    for name in load_stages(path):
        for method in methods if is_matrix(name, path) else [None]:
            yield f"{name}@{method}" if method else name, stage(name, method, path)


def _filled(text: str, params: dict[str, Any]) -> str:
    return re.sub(r"\$\{([\w.]+)\}", lambda match: str(_value(params, match[1])), text)


def _value(params: Any, key: str) -> Any:
    for name in key.split("."):
        params = params[name]
    return params


def _torn(locked: dict[str, Any]) -> list[str]:
    """Files that were in one state in one stage and in another in the next."""
    seen: dict[str, str] = {}
    found = []
    for name, entry in locked.items():
        for each in [*entry["deps"], *entry["outs"]]:
            if seen.setdefault(each["path"], each["md5"]) != each["md5"]:
                found.append(f"{name}: another {each['path']}")
    return found
