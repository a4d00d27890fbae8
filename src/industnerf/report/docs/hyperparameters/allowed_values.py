"""What a key of params.yaml may be: its choices and its range, as industnerf.schema has them."""

import re
import typing
from typing import Annotated, Any, Literal

from industnerf.schema import Params

LIST_INDEX = re.compile(r"\[\d+\]")


def allowed_values(key: str) -> str:
    """Of the dotted `key`, such as `levels[1].points`; an empty text if only its type matters."""
    annotation: Any = Params
    for name in LIST_INDEX.sub("", key).split("."):
        annotation = typing.get_type_hints(_section(annotation), include_extras=True)[name]
    return _describe(annotation)


def _section(annotation: Any) -> Any:
    """The dataclass of a section, or of the sections in a list."""
    while typing.get_origin(annotation) is not None:
        annotation = typing.get_args(annotation)[0]
    return annotation


def _describe(annotation: Any) -> str:
    origin, arguments = typing.get_origin(annotation), typing.get_args(annotation)
    if origin is Literal:
        return ", ".join(f"`{choice}`" for choice in arguments)
    if origin is list:
        item = _describe(arguments[0])
        return f"each {item}" if item else ""
    if origin is Annotated:
        rules = [rule.message for rule in arguments[1:]]
        return "; ".join(text for text in (_describe(arguments[0]), *rules) if text)
    return ""
