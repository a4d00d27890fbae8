"""The settings of a method from params.yaml, and what the command line says otherwise."""

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from industnerf import renamed
from industnerf.config import build, find_params, flatten, read_yaml
from industnerf.errors import BadParams
from industnerf.schema import Params


@dataclass(frozen=True)
class ResolvedConfig:
    """The settings and the seed of one run, and the file they come from."""

    method: str
    settings: Any
    seed: int
    source: Path

    def format_lines(self) -> list[str]:
        """`key = value` of every value used, sorted."""
        values = {"seed": self.seed, "method": {self.method: asdict(self.settings)}}
        return [f"{key} = {json.dumps(value)}" for key, value in sorted(flatten(values).items())]


def resolve_config(
    method: str, overrides: Sequence[str], params: Path | None = None
) -> ResolvedConfig:
    """The settings of `method` from `params`, with `overrides` such as `method.hull.points=9`.

    `params` is by default that of `find_params`.  Raises BadParams that names the key if one is
    unknown, mistyped or out of range, or `params` if it is not there.
    """
    if params and not params.exists():
        raise BadParams(f"--params {params} is missing")
    path = params or find_params()
    values = read_yaml(path)
    for override in overrides:
        _apply_override(values, override, method)
    validated = build(Params, values, " ".join([str(path), *overrides]))
    return ResolvedConfig(method, getattr(validated.method, method), validated.seed, path)


def _apply_override(values: dict[str, Any], override: str, method: str) -> None:
    key, separator, text = override.partition("=")
    if not separator:
        raise BadParams(f"--set {override}: must be KEY=VALUE")
    if key != "seed" and not key.startswith(f"method.{method}."):
        raise BadParams(f"--set {override}: only seed and method.{method}.* have a say here")
    if new := renamed.new_key(key):
        raise BadParams(f"--set {override}: {key} is now {new}")
    *sections, name = key.split(".")
    node = values
    for depth, section in enumerate(sections):
        node = _lookup(node, section, override, sections[:depth])
        if isinstance(node, list):
            raise BadParams(_list_error(override, [*sections[:depth], section]))
        if not isinstance(node, dict):
            raise BadParams(f"--set {override}: {section} is a value, not a section")
    _lookup(node, name, override, sections)
    node[name] = _parse_value(text)


def _lookup(section: dict[str, Any], name: str, override: str, parents: Sequence[str]) -> Any:
    """The value of `name` in `section`; raises BadParams if there is none."""
    if name in section:
        return section[name]
    base_name = name.partition("[")[0]
    if isinstance(section.get(base_name), list):
        raise BadParams(_list_error(override, [*parents, base_name]))
    key = override.partition("=")[0]
    raise BadParams(f"--set {override}: {key} is unknown; there are {', '.join(section)}")


def _list_error(override: str, sections: Sequence[str]) -> str:
    key = ".".join(sections)
    return (
        f"--set {override}: {key} is a list, which is given as a whole, as JSON: --set "
        f"'{key}=[...]'; --print-config prints it as it is"
    )


def _parse_value(text: str) -> Any:
    """JSON, and whatever is no JSON is a word: 1e-3 is a number here and `no` is none."""
    try:
        return json.loads(text)
    except ValueError:
        return text
