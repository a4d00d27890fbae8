"""What a user should know of one part before reading its scores: sentences beside the result.

    <part>/remarks.json      only where there is something to say

The stages `parts` and `views` write them; terminal and report show them.
"""

from collections.abc import Iterable
from pathlib import Path

from industnerf.artifacts.files import read_json, write_json

REMARKS, SCHEMA = "remarks.json", 1
MAX_SHOWN_PARTS = 10  # parts whose remarks a terminal shows


def save_remarks(folder: Path, remarks: Iterable[str]) -> None:
    """Write those of `remarks` that are not empty into `folder`; no file if there are none."""
    sentences = [remark for remark in remarks if remark]
    if sentences:
        write_json(folder / REMARKS, {"schema": SCHEMA, "remarks": sentences})


def load_remarks(out: Path, stage: str) -> dict[str, list[str]]:
    """Part id -> remarks, of the parts below `out`, what `stage` wrote, that have any."""
    return {
        path.parent.name: read_json(path, SCHEMA, stage)["remarks"]
        for path in sorted(out.glob(f"*/{REMARKS}"))
    }


def print_remarks(out: Path, stage: str) -> None:
    """Print a line for each of `load_remarks`, of the first MAX_SHOWN_PARTS parts."""
    remarks = load_remarks(out, stage)
    for part_id in list(remarks)[:MAX_SHOWN_PARTS]:
        for remark in remarks[part_id]:
            print(f"{stage}: {part_id}: {remark}")
    if len(remarks) > MAX_SHOWN_PARTS:
        print(f"{stage}: remarks on {len(remarks) - MAX_SHOWN_PARTS} more: {out / '*' / REMARKS}")
