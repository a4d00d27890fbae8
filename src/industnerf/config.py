"""From params.yaml to a stage: strict types, and only the keys that dvc.yaml lists for it.

dvc.yaml is the one place that says which parameters a stage reads.  A stage is handed exactly
those, so it reruns exactly when something it reads changes.
"""

import dataclasses
import typing
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, TypeVar

from omegaconf import OmegaConf
from omegaconf.errors import OmegaConfBaseException
from yaml import YAMLError

from industnerf.errors import BadParams, BadValue, UndeclaredParameter
from industnerf.schema import Params

T = TypeVar("T")
PARAMS, PIPELINE = Path("params.yaml"), Path("dvc.yaml")


def read_yaml(path: Path) -> dict[str, Any]:
    """`path` as a dict; raises BadParams that names the file if it is missing or not YAML.

    Always OmegaConf: other readers take 1e-3 for text, or `no` for a truth value.
    """
    try:
        content = OmegaConf.to_container(OmegaConf.load(path))
    except FileNotFoundError:
        hint = "; run from the root of the repository" if path.parent == Path() else ""
        raise BadParams(f"{path} is missing{hint}") from None
    except (YAMLError, OmegaConfBaseException, OSError) as error:
        raise BadParams(f"{path} is not readable: {error}") from None
    if not isinstance(content, dict):
        raise BadParams(f"{path} holds a {type(content).__name__}, not sections")
    return typing.cast(dict[str, Any], content)


def build(schema: type[T], values: object, where: str = "params.yaml") -> T:
    """`values` as a `schema`: every key present, none unknown, all types and rules as declared.

    Raises BadParams that names `where` and the key, and says what it must be.
    """
    return _typed(schema, values, where, "")


def load_params(path: Path = PARAMS) -> Params:
    """The whole of params.yaml, checked."""
    return build(Params, read_yaml(path), str(path))


@dataclasses.dataclass(frozen=True)
class Stage:
    """What dvc.yaml says of one stage."""

    name: str
    command: str
    params: tuple[str, ...]
    deps: tuple[str, ...]
    outs: tuple[str, ...]

    def mask(self, params: Params) -> Any:
        """`params` cut down to what this stage lists."""
        return Masked(params, self.params, self.name)


def load_stages(path: Path = PIPELINE) -> dict[str, dict[str, Any]]:
    """The stages of dvc.yaml, raw, in their order."""
    return read_yaml(path)["stages"]


def is_matrix(name: str, path: Path = PIPELINE) -> bool:
    """Whether the stage runs once per method."""
    return "matrix" in load_stages(path)[name]


def stage(name: str, item: str | None = None, path: Path = PIPELINE) -> Stage:
    """The stage `name`; of a matrix, the one of method `item`."""
    raw = load_stages(path)[name]

    def filled(texts: list[Any]) -> tuple[str, ...]:
        flat = [next(iter(text)) if isinstance(text, dict) else text for text in texts]
        return tuple(text.replace("${item.method}", item or "") for text in flat)

    return Stage(
        name,
        filled([raw["cmd"]])[0],
        filled(raw.get("params", [])),
        filled(raw.get("deps", [])),
        filled(raw.get("outs", [])),
    )


def flat(params: Mapping[str, Any], at: str = "") -> dict[str, Any]:
    """Nested sections to dotted keys."""
    found: dict[str, Any] = {}
    for key, value in params.items():
        found |= flat(value, f"{at}{key}.") if isinstance(value, Mapping) else {f"{at}{key}": value}
    return found


class Masked:
    """Parameters of which only the declared keys can be read."""

    def __init__(self, values: object, allowed: tuple[str, ...], stage: str, at: str = "") -> None:
        self._values, self._allowed, self._stage, self._at = values, allowed, stage, at

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        key = f"{self._at}{name}"
        if key in self._allowed:
            return getattr(self._values, name)
        if any(path.startswith(f"{key}.") for path in self._allowed):
            return Masked(getattr(self._values, name), self._allowed, self._stage, f"{key}.")
        raise UndeclaredParameter(
            f"stage {self._stage!r} reads {key!r}, which dvc.yaml does not list under its params "
            f"({', '.join(self._allowed)})"
        )


def _typed(kind: Any, value: Any, where: str, key: str) -> Any:
    origin, arguments = typing.get_origin(kind), typing.get_args(kind)
    if dataclasses.is_dataclass(kind):
        return _section(kind, value, where, key)
    if origin is Literal:
        return _expect(value in arguments, value, where, key, f"one of {', '.join(arguments)}")
    if origin is Annotated:
        typed = _typed(arguments[0], value, where, key)
        for rule in arguments[1:]:
            _expect(rule.holds(typed), typed, where, key, rule.words)
        return typed
    if origin is list:
        _expect(isinstance(value, list), value, where, key, "a list")
        return [_typed(arguments[0], each, where, f"{key}[{i}]") for i, each in enumerate(value)]
    if kind is float:
        number = isinstance(value, int | float) and not isinstance(value, bool)
        return float(_expect(number, value, where, key, "a number"))
    exact = type(value) is kind  # so that `true` is no int and 40.0 no count
    names = {int: "a whole number", str: "a text", bool: "true or false"}
    return _expect(exact, value, where, key, names[kind])


def _section(kind: Any, value: Any, where: str, key: str) -> Any:
    name = key or "the file"
    _expect(isinstance(value, Mapping), value, where, name, "a section with keys")
    types_of = typing.get_type_hints(kind, include_extras=True)
    unknown, missing = sorted(set(value) - set(types_of)), sorted(set(types_of) - set(value))
    prefix = f"{key}." if key else ""
    if unknown:
        raise BadParams(
            f"{where}: {prefix}{unknown[0]} is unknown; {name} has {', '.join(types_of)}"
        )
    if missing:
        raise BadParams(f"{where}: {prefix}{missing[0]} is missing")
    typed = {field: _typed(t, value[field], where, prefix + field) for field, t in types_of.items()}
    try:
        return kind(**typed)
    except BadValue as error:
        raise BadParams(f"{where}: {prefix}{error}") from None


def _expect(holds: bool, value: Any, where: str, key: str, rule: str) -> Any:
    if not holds:
        raise BadParams(f"{where}: {key} is {value!r}, must be {rule}")
    return value
