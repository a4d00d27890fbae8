"""What a job and the process that waits for it tell each other: files in a folder both can see.

<folder>/<index>.started    a process is at this piece of work, or was when its job ended
<folder>/<index>.json     how it ended
"""

import json
import os
from dataclasses import dataclass
from pathlib import Path

from industnerf.runner.base import WorkItem, WorkResult


@dataclass(frozen=True)
class JobStatus:
    folder: Path

    def run(self, index: int, work_item: WorkItem) -> None:
        """Do the piece of work number `index`, having noted that it has begun."""
        (self.folder / f"{index}.started").touch()
        work_item()

    def started(self) -> set[int]:
        """The pieces of work that a process is or was at."""
        return self._indices_with_suffix(".started")

    def write(self, result: WorkResult) -> None:
        """Note how a piece of work ended, in one rename: half a note is never seen."""
        draft = self.folder / f".{result.index}-{os.getpid()}"
        draft.write_text(json.dumps({"error": result.error, "lost": result.lost}))
        draft.rename(self.folder / f"{result.index}.json")

    def finished(self) -> set[int]:
        """The pieces of work of which it is known how they ended."""
        return self._indices_with_suffix(".json")

    def result(self, index: int) -> WorkResult:
        """How the piece of work number `index` ended."""
        text = (self.folder / f"{index}.json").read_text(encoding="utf-8")
        return WorkResult(index, **json.loads(text))

    def _indices_with_suffix(self, suffix: str) -> set[int]:
        # Listing the folder makes network file systems look anew; asking for one file may not.
        names = (Path(entry.name) for entry in os.scandir(self.folder))
        return {int(name.stem) for name in names if name.suffix == suffix}
