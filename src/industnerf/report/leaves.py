"""Nested settings to dotted keys; sections in a list stand apart: `levels[1].points`."""

from collections.abc import Mapping
from typing import Any


def leaves(values: Any, at: str = "") -> dict[str, Any]:
    """Every value that is no section; a list is one value, unless sections are in it."""
    if isinstance(values, Mapping):
        parts = {f"{at}.{key}" if at else str(key): value for key, value in values.items()}
    elif isinstance(values, list) and any(isinstance(value, Mapping) for value in values):
        parts = {f"{at}[{i}]": value for i, value in enumerate(values)}
    else:
        return {at: values}
    return {key: leaf for name, part in parts.items() for key, leaf in leaves(part, name).items()}
