"""The settings of a method from params.yaml, and what the command line says otherwise."""

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from industnerf.config import PARAMS, build, flat, read_yaml
from industnerf.errors import BadParams
from industnerf.schema import Params

SHIPPED = Path(__file__).parents[3] / PARAMS


@dataclass(frozen=True)
class Chosen:
    """The settings and the seed of one run, and the file they come from."""

    method: str
    settings: Any
    seed: int
    source: Path

    def lines(self) -> list[str]:
        """`key = value` of every value used, sorted."""
        values = {"seed": self.seed, "method": {self.method: asdict(self.settings)}}
        return [f"{key} = {json.dumps(value)}" for key, value in sorted(flat(values).items())]


def choose(method: str, overrides: Sequence[str], params: Path | None = None) -> Chosen:
    """The settings of `method` from `params`, with `overrides` such as `method.hull.points=9`.

    `params` is by default params.yaml of the current folder, else the one that came with the
    code.  Raises BadParams that names the key if one is unknown, mistyped or out of range, or
    `params` if it is not there.
    """
    if params and not params.exists():
        raise BadParams(f"--params {params} is missing")
    path = params or (PARAMS if PARAMS.exists() else SHIPPED)
    values = read_yaml(path)
    for override in overrides:
        _apply(values, override, method)
    checked = build(Params, values, " ".join([str(path), *overrides]))
    return Chosen(method, getattr(checked.method, method), checked.seed, path)


def _apply(values: dict[str, Any], override: str, method: str) -> None:
    key, equals, text = override.partition("=")
    if not equals:
        raise BadParams(f"--set {override}: must be KEY=VALUE")
    if key != "seed" and not key.startswith(f"method.{method}."):
        raise BadParams(f"--set {override}: only seed and method.{method}.* have a say here")
    *sections, name = key.split(".")
    place = values
    for depth, section in enumerate(sections):
        place = _entry(place, section, override, sections[:depth])
        if isinstance(place, list):
            raise BadParams(_whole_list(override, [*sections[:depth], section]))
        if not isinstance(place, dict):
            raise BadParams(f"--set {override}: {section} is a value, not a section")
    _entry(place, name, override, sections)
    place[name] = _value(text)


def _entry(place: dict[str, Any], name: str, override: str, within: Sequence[str]) -> Any:
    """What `place`, the section `within`, has as `name`; raises BadParams if there is nothing."""
    if name in place:
        return place[name]
    bare = name.partition("[")[0]
    if isinstance(place.get(bare), list):
        raise BadParams(_whole_list(override, [*within, bare]))
    key = override.partition("=")[0]
    raise BadParams(f"--set {override}: {key} is unknown; there are {', '.join(place)}")


def _whole_list(override: str, sections: Sequence[str]) -> str:
    key = ".".join(sections)
    return (
        f"--set {override}: {key} is a list, which is given as a whole, as JSON: --set "
        f"'{key}=[...]'; --show prints it as it is"
    )


def _value(text: str) -> Any:
    """JSON, and whatever is no JSON is a word: 1e-3 is a number here and `no` is none."""
    try:
        return json.loads(text)
    except ValueError:
        return text
