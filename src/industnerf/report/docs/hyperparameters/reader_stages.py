"""Which stages of dvc.yaml read a parameter."""

import json
from typing import Any


def reader_stages(key: str, stages: dict[str, dict[str, Any]]) -> list[str]:
    """The stages that list `key` or a section above it, or have it in their wiring."""
    return [
        name
        for name, stage in stages.items()
        if _depends_on(key, stage) or _interpolates(key, stage)
    ]


def _depends_on(key: str, stage: dict[str, Any]) -> bool:
    method = key.split(".")[1] if key.startswith("method.") else ""
    listed = [name.replace("${item.method}", method) for name in stage.get("params", [])]
    return any(key == name or key.startswith((f"{name}.", f"{name}[")) for name in listed)


def _interpolates(key: str, stage: dict[str, Any]) -> bool:
    return f"${{{key}}}" in json.dumps(stage)
