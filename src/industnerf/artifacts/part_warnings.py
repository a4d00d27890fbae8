"""What a user should know of one part before reading its scores: sentences beside the result.

    <part>/warnings.json      only where there is something to say

The stages `parts` and `views` write them; terminal and report show them.
"""

from collections.abc import Iterable
from pathlib import Path

from industnerf.artifacts.files import read_json, write_json

WARNINGS, SCHEMA = "warnings.json", 1
MAX_SHOWN_PARTS = 10  # parts whose warnings a terminal shows


def save_part_warnings(folder: Path, warnings: Iterable[str]) -> None:
    """Write those of `warnings` that are not empty into `folder`; no file if there are none."""
    sentences = [warning for warning in warnings if warning]
    if sentences:
        write_json(folder / WARNINGS, {"schema": SCHEMA, "warnings": sentences})


def load_part_warnings(out: Path, stage: str) -> dict[str, list[str]]:
    """Part id -> warnings, of the parts below `out`, what `stage` wrote, that have any."""
    return {
        path.parent.name: read_json(path, SCHEMA, stage)["warnings"]
        for path in sorted(out.glob(f"*/{WARNINGS}"))
    }


def print_part_warnings(out: Path, stage: str) -> None:
    """Print a line for each of `load_part_warnings`, of the first MAX_SHOWN_PARTS parts."""
    warnings = load_part_warnings(out, stage)
    for part_id in list(warnings)[:MAX_SHOWN_PARTS]:
        for warning in warnings[part_id]:
            print(f"{stage}: {part_id}: {warning}")
    if (more := len(warnings) - MAX_SHOWN_PARTS) > 0:
        print(f"{stage}: warnings on {more} more: {out / '*' / WARNINGS}")
