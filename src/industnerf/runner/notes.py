"""What a job and the process that waits for it tell each other: files in a folder both can see.

<folder>/<index>.begun    a process is at this piece of work, or was when its job ended
<folder>/<index>.json     how it ended
"""

import json
import os
from dataclasses import dataclass
from pathlib import Path

from industnerf.runner.base import Outcome, Work


@dataclass(frozen=True)
class Notes:
    folder: Path

    def begin(self, index: int, work: Work) -> None:
        """Do the piece of work number `index`, having noted that it has begun."""
        (self.folder / f"{index}.begun").touch()
        work()

    def begun(self) -> set[int]:
        """The pieces of work that a process is or was at."""
        return self._with(".begun")

    def write(self, outcome: Outcome) -> None:
        """Note how a piece of work ended, in one rename: half a note is never seen."""
        draft = self.folder / f".{outcome.index}-{os.getpid()}"
        draft.write_text(json.dumps({"error": outcome.error, "lost": outcome.lost}))
        draft.rename(self.folder / f"{outcome.index}.json")

    def ended(self) -> set[int]:
        """The pieces of work of which it is known how they ended."""
        return self._with(".json")

    def outcome(self, index: int) -> Outcome:
        """How the piece of work number `index` ended."""
        text = (self.folder / f"{index}.json").read_text(encoding="utf-8")
        return Outcome(index, **json.loads(text))

    def _with(self, suffix: str) -> set[int]:
        # Listing the folder makes network file systems look anew; asking for one file may not.
        names = (Path(entry.name) for entry in os.scandir(self.folder))
        return {int(name.stem) for name in names if name.suffix == suffix}
