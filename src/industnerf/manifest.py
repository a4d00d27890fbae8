"""What a result in the store holds: the name, size, time and SHA-256 of every file, written last.

Without it a result is not whole.  On use, names, sizes and times are compared; a file of another
time is read.  Files are linked to where they are used, and whoever writes through such a link, as
root can, changes its time.  `archives` has the digests of what is in the zip archives among them.
"""

import json
import os
from collections.abc import Iterator
from pathlib import Path

from industnerf.content import ARCHIVE_SUFFIX, archive_digests, file_digest, top_digests

FILE = "manifest.json"
SCHEMA = 1
RESULT = "out/"


def write_manifest(folder: Path) -> None:
    """Make all files of `folder` read-only, force them to disk, and note what they are."""
    files, archives = {}, {}
    for name, path in sorted(_files(folder)):
        path.chmod(0o444)
        fsync(path)
        status = path.stat()
        files[name] = [status.st_size, status.st_mtime_ns, file_digest(path)]
        if path.suffix == ARCHIVE_SUFFIX:
            archives[name] = archive_digests(path)
    manifest = folder / FILE
    content = {"schema": SCHEMA, "files": files, "archives": archives}
    manifest.write_text(json.dumps(content, indent=0))
    manifest.chmod(0o444)
    fsync(manifest)


def read_contents(folder: Path) -> dict[str, str]:
    """The digest of each file and folder of the result in `folder`, and of each in its archives.

    Raises OSError or ValueError if there is no result, or its manifest is torn.
    """
    content = json.loads((folder / FILE).read_text(encoding="utf-8"))
    files = {
        name.removeprefix(RESULT): digest
        for name, (_, _, digest) in content["files"].items()
        if name.startswith(RESULT)
    }
    members = {
        f"{name.removeprefix(RESULT)}/{member}": digest
        for name, digests in content.get("archives", {}).items()
        for member, digest in digests.items()
    }
    return top_digests(files) | members


def find_damage(folder: Path, *, read_all: bool = False) -> str:
    """How the files of `folder` differ from its manifest, or an empty text.

    Those of the noted size and time are read only with `read_all`.
    """
    try:
        content = json.loads((folder / FILE).read_text(encoding="utf-8"))
        expected = {name: tuple(values) for name, values in content["files"].items()}
    except FileNotFoundError:
        return f"has no {FILE}"
    except (ValueError, TypeError, KeyError, AttributeError):
        return f"{FILE} is torn"
    found = dict(_files(folder))
    if missing := sorted(expected.keys() - found.keys()):
        return _count("are missing", missing, expected)
    if unknown := sorted(found.keys() - expected.keys()):
        return f"{len(unknown)} files do not belong to it, such as {unknown[0]}"
    changed = [
        name
        for name, path in found.items()
        if _differs(path, *expected[name], read_always=read_all)
    ]
    return _count("have another content", sorted(changed), expected) if changed else ""


def fsync(path: Path) -> None:
    """Force a file, or the names in a folder, to disk."""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _count(what: str, names: list[str], expected: dict[str, tuple]) -> str:
    return f"{len(names)} of {len(expected)} files {what}, such as {names[0]}"


def _differs(path: Path, size: int, mtime_ns: int, digest: str, *, read_always: bool) -> bool:
    if path.is_symlink():  # the store makes none; where one leads to is not its own
        return True
    status = path.stat()
    if status.st_size != size:
        return True
    return (read_always or status.st_mtime_ns != mtime_ns) and file_digest(path) != digest


def _files(folder: Path) -> Iterator[tuple[str, Path]]:
    """Relative name and path of every file but the manifest."""
    for parent, _, names in os.walk(folder):
        for path in (Path(parent, name) for name in names):
            if (name := str(path.relative_to(folder))) != FILE:
                yield name, path
