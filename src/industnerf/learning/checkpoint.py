"""Checkpoints of a training: one file, written whole, by one process or by several.

Two processes may train the same network (`dvc repro` beside a sweep): each writes its own draft.
"""

import io
import pickle
import sys
import zipfile
from pathlib import Path
from typing import Any

import torch

from industnerf.artifacts.files import atomic_write

CORRUPT_ERRORS = (
    OSError,
    RuntimeError,
    EOFError,
    ValueError,
    pickle.UnpicklingError,
    zipfile.BadZipFile,
)
OUT_OF_MEMORY = "allocate memory"  # torch has an error of no kind of its own for it


def save(path: Path, state: dict[str, Any]) -> None:
    """Write `state`, plain data and tensors; raises BadArtifact if it cannot be written."""
    with atomic_write(path) as temporary:
        temporary.parent.mkdir(parents=True, exist_ok=True)
        with temporary.open("wb") as file:
            torch.save(state, file)


def load(path: Path) -> dict[str, Any] | None:
    """What `save` wrote, on the CPU; None where there is nothing, or nothing that can be read.

    A truncated file is reported and removed: the training starts anew, and does not fail.
    Raises OSError or MemoryError where it is the machine that cannot read it: then it stays.
    """
    try:
        content = io.BytesIO(path.read_bytes())
    except FileNotFoundError:  # none yet, or another process found it torn
        return None
    try:
        return torch.load(content, map_location="cpu", weights_only=True)
    except CORRUPT_ERRORS as error:
        if OUT_OF_MEMORY in str(error):
            raise MemoryError(f"{path} needs more than there is") from error
        print(f"{path} cannot be read ({error}): the training starts anew", file=sys.stderr)
        path.unlink(missing_ok=True)
        return None
