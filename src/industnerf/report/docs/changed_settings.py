"""What of params.yaml is no longer as a published study had it."""

import re
from collections import Counter
from collections.abc import Set
from itertools import accumulate
from pathlib import Path

from industnerf.config import flatten, read_yaml

METHOD_KEY = re.compile(r"^method\.\w+\.")
CHANGED_SINCE = (
    "Some settings in `params.yaml` are no longer those of the study. A new run has others here:"
)


def changed_settings(published_params: Path, current_params: Path) -> str:
    """A Markdown list of the keys that have another value, are new or are removed; or nothing."""
    old, new = (flatten(read_yaml(path)) for path in (published_params, current_params))
    changed = {key for key in old.keys() & new.keys() if old[key] != new[key]}
    changes = {
        "another value": {".".join(key.split(".")[:3]) for key in changed},
        "new": _only_in(new.keys(), old.keys()),
        "removed": _only_in(old.keys(), new.keys()),
    }
    lines = [
        f"- {what}: {', '.join(f'`{key}`' for key in _join_methods(keys))}\n"
        for what, keys in changes.items()
        if keys
    ]
    return f"{CHANGED_SINCE}\n\n{''.join(lines)}\n" if lines else ""


def _join_methods(keys: Set[str]) -> list[str]:
    """`keys` in order; one that several methods share stands once, as `method.*.key`."""
    settings = Counter(METHOD_KEY.sub("", key) for key in keys if METHOD_KEY.match(key))
    return sorted(
        {
            f"method.*.{setting}" if settings[setting := METHOD_KEY.sub("", key)] > 1 else key
            for key in keys
        }
    )


def _only_in(these: Set[str], those: Set[str]) -> set[str]:
    """Keys of `these` that are not in `those`: where a whole section is not, the section."""
    known = {section for key in those for section in _sections(key)}
    return {next((s for s in _sections(key) if s not in known), key) for key in these - those}


def _sections(key: str) -> list[str]:
    """What `key` is in, from the widest to itself: a, a.b, a.b.c."""
    return list(accumulate(key.split("."), "{}.{}".format))
