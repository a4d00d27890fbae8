"""JSON and npz files, and the errors of those that cannot be read."""

import json
import os
import socket
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import numpy as np

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


def write_text(path: Path, text: str) -> None:
    """Write `text` to `path`, in a folder made for it; raises BadArtifact if it cannot."""
    with atomic_write(path) as draft:
        draft.parent.mkdir(parents=True, exist_ok=True)
        draft.write_text(text, "utf-8", "surrogateescape")  # names of files are any bytes


def write_json(path: Path, content: Any) -> None:
    """Write `content` as indented JSON, byte-equal for equal content."""
    write_text(path, json_text(content))


def json_text(content: Any) -> str:
    """`content` as indented JSON."""
    return json.dumps(content, indent=1, allow_nan=False) + "\n"


def corrupt_error(path: Path, what: str, stage: str) -> BadArtifact:
    """The refusal of the file `path`, with which `what` is wrong and that `stage` writes.

    Results are links to what the store holds, so one that was cut or changed where it lies is so
    there too, and would be taken from there again.
    """
    return BadArtifact(
        f"{path} {what}. `python -m industnerf.doctor` says what to remove if the store's own is "
        f"torn; then `dvc repro -f -s {stage}` writes it anew, or once more the sweep or preset "
        "that it is of."
    )


def missing_error(path: Path, stage: str) -> BadArtifact:
    """The refusal of the file `path`, which `stage` would have written and which is not there."""
    return BadArtifact(
        f"{path} is missing. `dvc repro {stage}` writes it, or once more the sweep or preset "
        "that it is of."
    )


def read_json(path: Path, schema: int, stage: str) -> Any:
    """The JSON object in `path`, whose `schema` must be `schema`.

    Raises BadArtifact that names the file and how `stage` writes it anew.
    """
    try:
        data = path.read_bytes()
    except FileNotFoundError:
        raise missing_error(path, stage) from None
    except OSError as error:
        raise corrupt_error(path, f"is not readable JSON ({error})", stage) from None
    return parse_json(data, path, schema, stage)


def parse_json(data: bytes, path: Path, schema: int, stage: str) -> Any:
    """As `read_json`, of what `path` holds."""
    try:
        content = json.loads(data)
    except ValueError as error:
        raise corrupt_error(path, f"is not readable JSON ({error})", stage) from None
    found_schema = content.get("schema") if isinstance(content, dict) else None
    if found_schema != schema:
        raise corrupt_error(path, f"has schema {found_schema}, this code reads {schema}", stage)
    return content


def read_npz(path: Path, names: tuple[str, ...], stage: str) -> list[np.ndarray]:
    """The arrays `names` of `path`; raises BadArtifact if one is missing or the file is torn."""
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as arrays:
            return [arrays[name] for name in names]
    except FileNotFoundError:
        raise missing_error(path, stage) from None
    except (OSError, ValueError, KeyError, EOFError, TypeError, zipfile.BadZipFile) as error:
        raise corrupt_error(path, f"cannot be read ({error})", stage) from None
