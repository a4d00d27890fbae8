"""What a key of params.yaml may be: its choices and its range, as industnerf.schema has them."""

import re
import typing
from typing import Annotated, Any, Literal

from industnerf.schema import Params

ITEM = re.compile(r"\[\d+\]")


def allowed(key: str) -> str:
    """Of the dotted `key`, such as `levels[1].points`; an empty text if only its type matters."""
    kind: Any = Params
    for name in ITEM.sub("", key).split("."):
        kind = typing.get_type_hints(_section(kind), include_extras=True)[name]
    return _words(kind)


def _section(kind: Any) -> Any:
    """The dataclass of a section, or of the sections in a list."""
    while typing.get_origin(kind) is not None:
        kind = typing.get_args(kind)[0]
    return kind


def _words(kind: Any) -> str:
    origin, arguments = typing.get_origin(kind), typing.get_args(kind)
    if origin is Literal:
        return ", ".join(f"`{choice}`" for choice in arguments)
    if origin is list:
        each = _words(arguments[0])
        return f"each {each}" if each else ""
    if origin is Annotated:
        rules = [rule.words for rule in arguments[1:]]
        return "; ".join(words for words in (_words(arguments[0]), *rules) if words)
    return ""
