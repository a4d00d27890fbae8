"""Nested settings to dotted keys; sections in a list stand apart: `levels[1].points`."""

from collections.abc import Mapping
from typing import Any


def flatten(values: Any, prefix: str = "") -> dict[str, Any]:
    """Every value that is no section; a list is one value, unless sections are in it."""
    if isinstance(values, Mapping):
        sections = {
            f"{prefix}.{key}" if prefix else str(key): value for key, value in values.items()
        }
    elif isinstance(values, list) and any(isinstance(value, Mapping) for value in values):
        sections = {f"{prefix}[{i}]": value for i, value in enumerate(values)}
    else:
        return {prefix: values}
    return {
        key: leaf
        for name, section in sections.items()
        for key, leaf in flatten(section, name).items()
    }
