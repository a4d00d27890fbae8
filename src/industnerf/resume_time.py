"""What earlier attempts at a result took, with whose work a resumed one goes on.

<scratch>/attempt.json    when the last attempt began, and the seconds of those before it
"""

import json
import os
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from industnerf.artifacts.files import write_json

RECORD_FILE = "attempt.json"


def start_timer(scratch: Path) -> float:
    """Note that an attempt begins; returns the seconds of those before it that left something."""
    earlier_seconds = elapsed(scratch)
    write_json(scratch / RECORD_FILE, {"before": earlier_seconds, "begun": time.time()})
    return earlier_seconds


def elapsed(scratch: Path) -> float:
    """Seconds from the beginning of each attempt to the last file that it saved in `scratch`."""
    try:
        record = json.loads((scratch / RECORD_FILE).read_text(encoding="utf-8"))
    except (OSError, ValueError):  # there was none, or its note is torn
        return 0.0
    return record["before"] + max(
        0.0, max(_save_times(scratch), default=record["begun"]) - record["begun"]
    )


def _save_times(scratch: Path) -> Iterator[float]:
    """When each file was saved, but for the note and for drafts, which may vanish meanwhile."""
    for folder, _, names in os.walk(scratch):
        for name in names:
            if name != RECORD_FILE and not name.startswith("."):
                with suppress(FileNotFoundError):
                    yield (Path(folder) / name).stat().st_mtime
