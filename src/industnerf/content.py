"""Digests of what results are made from: of files, of folders, and of members of zip archives.

An archive is a folder here: `views/photographs.zip/rgb` is all that it holds below `rgb/`.  What a
stage has written is not read again: the store has digested it, and `index.json` says so.
"""

import hashlib
import json
import zipfile
from collections import defaultdict
from collections.abc import Iterable, Mapping
from pathlib import Path

ARCHIVE_SUFFIX = ".zip"
RECORD = "index.json"


def content_digest(paths: Iterable[Path], recorded: "RecordedDigests | None" = None) -> str:
    """A digest of files, folders and members of archives by name and content.

    What is `recorded` is not read.
    """
    lines = [f"{(recorded and recorded.find(path)) or digest(path)} {path.name}" for path in paths]
    return _text_digest("\n".join(lines))


def digest(path: Path) -> str:
    """The digest of the content of `path`; of a file it is the SHA-256."""
    if path.is_file():
        return file_digest(path)
    if path.is_dir():
        files = (file for file in path.rglob("*") if file.is_file())
        return tree_digest({str(file.relative_to(path)): file_digest(file) for file in files})
    for archive in path.parents:
        if archive.suffix == ARCHIVE_SUFFIX and archive.is_file():
            return archive_digests(archive)[path.relative_to(archive).as_posix()]
    raise FileNotFoundError(path)


def file_digest(path: Path) -> str:
    """The SHA-256 of the file `path`."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def archive_digests(path: Path) -> dict[str, str]:
    """The digest of every file and folder at the top of the archive `path`."""
    with zipfile.ZipFile(path) as archive:
        return top_digests(
            {name: hashlib.sha256(archive.read(name)).hexdigest() for name in archive.namelist()}
        )


def top_digests(files: Mapping[str, str]) -> dict[str, str]:
    """From the digests of `files` by their relative names, those of all at the top."""
    tops, below = {}, defaultdict[str, dict[str, str]](dict)
    for name, file in files.items():
        top, separator, rest = name.partition("/")
        if separator:
            below[top][rest] = file
        else:
            tops[top] = file
    return tops | {name: tree_digest(children) for name, children in below.items()}


def tree_digest(files: Mapping[str, str]) -> str:
    """The digest of a folder that holds `files`, digests by their relative names."""
    tops = sorted(top_digests(files).items())
    return _text_digest("\n".join(f"{value} {name}" for name, value in tops))


class RecordedDigests:
    """Digests that stages before have recorded, of each folder read at most once."""

    def __init__(self) -> None:
        self._contents: dict[Path, dict[str, dict[str, str]]] = {}

    def find(self, path: Path) -> str | None:
        """The digest of `path`, a result or what is in one; None if no stage has recorded it."""
        for out in path.parents[:3]:
            if out not in self._contents:
                self._contents[out] = _read_contents(out)
            result, *rest = path.relative_to(out).parts
            if (files := self._contents[out].get(result)) is not None:
                name = "/".join(rest)
                whole = {name: value for name, value in files.items() if "/" not in name}
                return files.get(name) if name else tree_digest(whole)
        return None


def _read_contents(out: Path) -> dict[str, dict[str, str]]:
    try:
        return json.loads((out / RECORD).read_bytes()).get("contents", {})
    except (OSError, ValueError, AttributeError):  # no folder of a stage, or one of older code
        return {}


def _text_digest(text: str) -> str:
    return hashlib.sha256(text.encode(errors="surrogateescape")).hexdigest()  # names are any bytes
