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

from industnerf import renamed
from industnerf.errors import BadParams, BadValue, UndeclaredParameter
from industnerf.schema import Params
from industnerf.schema.validators import Rule, one_of
from industnerf.suggestions import closest_names, did_you_mean

T = TypeVar("T")
PARAMS, PIPELINE = Path("params.yaml"), Path("dvc.yaml")
DEFAULT_PARAMS = Path(__file__).parents[2] / PARAMS


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


def build(schema: type[T], values: object, source: str = "params.yaml") -> T:
    """`values` as a `schema`: every key present, none unknown, all types and rules as declared.

    Raises BadParams that names `source` and the key, and says what it must be.
    """
    return _check_type(schema, values, source, "")


def load_params(path: Path = PARAMS) -> Params:
    """The whole of params.yaml, checked."""
    return build(Params, read_yaml(path), str(path))


def load_preset(preset: Path, path: Path = PARAMS) -> Params:
    """params.yaml with the values of a preset over it, checked."""
    values = OmegaConf.merge(read_yaml(path), read_yaml(preset))
    return build(Params, OmegaConf.to_container(values), str(preset))


def find_params() -> Path:
    """params.yaml of the current folder, else the one that came with the code."""
    return PARAMS if PARAMS.exists() else DEFAULT_PARAMS


@dataclasses.dataclass(frozen=True)
class Stage:
    """What dvc.yaml says of one stage."""

    name: str
    command: str
    params: tuple[str, ...]
    deps: tuple[str, ...]
    outs: tuple[str, ...]

    def select_params(self, params: Params) -> Any:
        """`params` cut down to what this stage lists."""
        return StageParams(params, self.params, self.name)


def load_stages(path: Path = PIPELINE) -> dict[str, dict[str, Any]]:
    """The stages of dvc.yaml, raw, in their order."""
    return read_yaml(path)["stages"]


def load_stage(name: str, path: Path = PIPELINE) -> Stage:
    """The stage `name`."""
    raw = load_stages(path)[name]
    lists = (tuple(raw.get(key, [])) for key in ("params", "deps", "outs"))
    return Stage(name, raw["cmd"], *lists)


def flatten(values: Any, prefix: str = "", *, split_lists: bool = False) -> dict[str, Any]:
    """Nested sections to dotted keys.

    With `split_lists` sections in a list have keys of their own, `levels[1].points`; else, and in
    all other cases, a list is one value.
    """
    if isinstance(values, Mapping):
        dot = "." if prefix else ""
        sections = {f"{prefix}{dot}{key}": value for key, value in values.items()}
    elif split_lists and isinstance(values, list) and any(isinstance(v, Mapping) for v in values):
        sections = {f"{prefix}[{i}]": value for i, value in enumerate(values)}
    else:
        return {prefix: values}
    return {
        key: leaf
        for name, section in sections.items()
        for key, leaf in flatten(section, name, split_lists=split_lists).items()
    }


class StageParams:
    """Parameters of which only the declared keys can be read."""

    def __init__(
        self, values: object, allowed: tuple[str, ...], stage: str, prefix: str = ""
    ) -> None:
        self._values, self._allowed, self._stage, self._prefix = values, allowed, stage, prefix

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        key = f"{self._prefix}{name}"
        if key in self._allowed:
            return getattr(self._values, name)
        if any(path.startswith(f"{key}.") for path in self._allowed):
            return StageParams(getattr(self._values, name), self._allowed, self._stage, f"{key}.")
        raise UndeclaredParameter(
            f"stage {self._stage!r} reads {key!r}, which dvc.yaml does not list under its params "
            f"({', '.join(self._allowed)})"
        )


def _check_type(expected_type: Any, value: Any, source: str, key: str) -> Any:
    origin, arguments = typing.get_origin(expected_type), typing.get_args(expected_type)
    if dataclasses.is_dataclass(expected_type):
        return _build_section(expected_type, value, source, key)
    if origin is Literal:
        if value not in arguments and (new := renamed.new_value(key, value)):
            raise BadParams(f"{source}: {key}: {value} is now {new}")
        return _expect_rule(one_of(arguments), value, source, key)
    if origin is Annotated:
        typed = _check_type(arguments[0], value, source, key)
        for rule in arguments[1:]:
            _expect_rule(rule, typed, source, key)
        return typed
    if origin is list:
        example = f": [{value}]" if isinstance(value, str) else ""
        _expect(isinstance(value, list), value, source, key, f"a list{example}")
        return [
            _check_type(arguments[0], item, source, f"{key}[{i}]") for i, item in enumerate(value)
        ]
    if expected_type is float:
        is_number = isinstance(value, int | float) and not isinstance(value, bool)
        return float(_expect(is_number, value, source, key, "a number"))
    is_exact_type = type(value) is expected_type  # so that `true` is no int and 40.0 no count
    type_names = {int: "a whole number", str: "a text", bool: "true or false"}
    return _expect(is_exact_type, value, source, key, type_names[expected_type])


def _build_section(section_type: Any, value: Any, source: str, key: str) -> Any:
    name = key or "the file"
    _expect(isinstance(value, Mapping), value, source, name, "a section with keys")
    field_types = typing.get_type_hints(section_type, include_extras=True)
    unknown, missing = sorted(set(value) - set(field_types)), sorted(set(field_types) - set(value))
    prefix = f"{key}." if key else ""
    for field in unknown:
        if new := renamed.new_key(prefix + field):
            raise BadParams(f"{source}: {prefix}{field} is now {new}")
    if unknown:
        closest = [prefix + field for field in closest_names(unknown[0], field_types)]
        raise BadParams(
            f"{source}: {prefix}{unknown[0]} is unknown{did_you_mean(prefix + unknown[0], closest)}"
            f"; {name} has {', '.join(field_types)}"
        )
    if missing:
        raise BadParams(f"{source}: {prefix}{missing[0]} is missing")
    typed = {
        field: _check_type(field_type, value[field], source, prefix + field)
        for field, field_type in field_types.items()
    }
    try:
        return section_type(**typed)
    except BadValue as error:
        raise BadParams(f"{source}: {prefix}{error}") from None


def _expect_rule(rule: Rule, value: Any, source: str, key: str) -> Any:
    advice = did_you_mean(value, rule.choices) if isinstance(value, str) else ""
    return _expect(rule.is_valid(value), value, source, key, rule.message + advice)


def _expect(is_valid: bool, value: Any, source: str, key: str, rule: str) -> Any:
    if not is_valid:
        raise BadParams(f"{source}: {key} is {value!r}, must be {rule}")
    return value
