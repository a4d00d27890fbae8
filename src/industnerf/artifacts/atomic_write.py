"""Files that are written whole or not at all."""

import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from industnerf.errors import BadArtifact


@contextmanager
def atomic_write(path: Path) -> Iterator[Path]:
    """A temporary file that becomes `path` in one rename; raises BadArtifact if it cannot."""
    draft = path.with_name(f".{path.name}.{socket.gethostname()}.{os.getpid()}")
    try:
        yield draft
        with draft.open("rb") as file:
            os.fsync(file.fileno())
        draft.replace(path)
    except OSError as error:
        raise BadArtifact(f"{path}: cannot be written: {error.strerror or error}") from None
    finally:
        with suppress(OSError):  # there is none, or no folder for it
            draft.unlink()


def check_writable(path: Path, option: str) -> None:
    """Make the folder of `path`, and see that it can be written, before any work is done."""
    if path.is_dir():
        raise BadArtifact(f"{option} {path}: is a folder")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with atomic_write(path.with_name(f".{path.name}.try")) as draft:
            draft.touch()
        path.with_name(f".{path.name}.try").unlink()
    except (OSError, BadArtifact) as error:
        reason = error.strerror if isinstance(error, OSError) else "no file can be made beside it"
        raise BadArtifact(f"{option} {path}: cannot be written: {reason}") from None
