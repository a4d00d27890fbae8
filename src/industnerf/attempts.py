"""What earlier attempts at a result took, with whose work a resumed one goes on.

<scratch>/attempt.json    when the last attempt began, and the seconds of those before it
"""

import json
import time
from pathlib import Path

from industnerf.artifacts.files import write_json

FILE = "attempt.json"


def begin(scratch: Path) -> float:
    """Note that an attempt begins; returns the seconds of those before it that were not in vain."""
    before = spent(scratch)
    write_json(scratch / FILE, {"before": before, "begun": time.time()})
    return before


def spent(scratch: Path) -> float:
    """Seconds from the beginning of each attempt to the last file that it saved in `scratch`."""
    try:
        note = json.loads((scratch / FILE).read_text())
    except (OSError, ValueError):  # there was none, or its note is torn
        return 0.0
    saved = (path.stat().st_mtime for path in scratch.rglob("*") if path.name != FILE)
    return note["before"] + max(0.0, max(saved, default=note["begun"]) - note["begun"])
