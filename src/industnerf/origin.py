"""With what a result was made: libraries, Python, processor.  Read by reports, never in a key."""

import json
import platform
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

from industnerf import processor

FILE = "origin.json"


@dataclass(frozen=True)
class Origin:
    """`libraries` are those that the result depends on, with their versions."""

    libraries: Mapping[str, str]
    python: str
    processor: str
    isa: str

    @staticmethod
    def here(libraries: Mapping[str, str]) -> "Origin":
        """Of a result that this process makes."""
        return Origin(libraries, platform.python_version(), processor.model(), processor.isa())

    def save(self, folder: Path) -> None:
        """Write origin.json."""
        (folder / FILE).write_text(json.dumps(asdict(self)))

    @staticmethod
    def load(folder: Path) -> "Origin | None":
        """What `save` wrote, or None where it is gone or torn."""
        try:
            return Origin(**json.loads((folder / FILE).read_text(encoding="utf-8")))
        except (OSError, ValueError, TypeError):
            return None
