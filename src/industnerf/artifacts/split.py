"""Which parts are tuned on, which are reported, and which are held out together."""

from dataclasses import dataclass
from pathlib import Path

from industnerf.artifacts.files import read_json, write_json

SCHEMA = 1


@dataclass(frozen=True)
class Place:
    """Where one part stands."""

    split: str  # "dev": tuned on, in no headline mean; "test": reported
    fold: int | None  # of the test parts: which nets must not have seen it; None for dev


def save_split(path: Path, places: dict[str, Place]) -> None:
    """Write the place of every part id."""
    write_json(path, {"schema": SCHEMA, "parts": {part: vars(p) for part, p in places.items()}})


def load_split(path: Path) -> dict[str, Place]:
    """Read the place of every part id; raises BadArtifact if the file is missing or torn."""
    return {
        part: Place(**place) for part, place in read_json(path, SCHEMA, "split")["parts"].items()
    }
