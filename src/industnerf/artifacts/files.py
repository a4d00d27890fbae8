"""Small files, written whole or not at all."""

import json
import zipfile
from pathlib import Path
from typing import Any

import numpy as np

from industnerf.artifacts.whole import written_whole
from industnerf.errors import BadArtifact


def write_text(path: Path, text: str) -> None:
    """Write `text` to `path`, in a folder made for it; raises BadArtifact if it cannot."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with written_whole(path) as draft:
        draft.write_text(text, errors="surrogateescape")  # names of files are any bytes


def write_json(path: Path, content: Any) -> None:
    """Write `content` as indented JSON, byte-equal for equal content."""
    write_text(path, json.dumps(content, indent=1, allow_nan=False) + "\n")


def read_json(path: Path, schema: int, stage: str) -> Any:
    """The JSON object in `path`, whose `schema` must be `schema`.

    Raises BadArtifact that names the file and the DVC stage that writes it anew.
    """
    try:
        content = json.loads(path.read_text())
    except FileNotFoundError:
        raise BadArtifact(f"{path} is missing; `dvc repro {stage}` writes it.") from None
    except ValueError as error:
        raise BadArtifact(
            f"{path} is not readable JSON ({error}); `dvc repro -f {stage}` writes it anew."
        ) from None
    found = content.get("schema") if isinstance(content, dict) else None
    if found != schema:
        raise BadArtifact(
            f"{path} has schema {found}, this code reads {schema}; `dvc repro -f {stage}`"
        )
    return content


def read_npz(path: Path, names: tuple[str, ...], stage: str) -> list[np.ndarray]:
    """The arrays `names` of `path`; raises BadArtifact if one is missing or the file is torn."""
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as arrays:
            return [arrays[name] for name in names]
    except (OSError, ValueError, KeyError, EOFError, TypeError, zipfile.BadZipFile) as error:
        raise BadArtifact(
            f"{path} cannot be read ({error}); `dvc repro -f {stage}` writes it anew."
        ) from None
