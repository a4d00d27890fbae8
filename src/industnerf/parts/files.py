"""The user's own files: which there are, and what they are called."""

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from industnerf.errors import BadParams
from industnerf.parts.reading.formats import SUFFIXES


@dataclass(frozen=True)
class OwnFile:
    """One file, its id in the study, and its family: the folder it is in."""

    file_id: str
    family: str
    path: Path


def find_files(place: Path, pattern: str, select: list[str]) -> list[OwnFile]:
    """The CAD files at `place`: itself, or those in it that match `pattern`, by id.

    In a folder, files of types that are never read are passed over, as are hidden ones, and all
    in hidden folders.  With `select`, only files that it names, or of which it names a solid.
    Raises BadParams if there is none, or if two would share an id.
    """
    require_place(place)
    if place.is_file():
        return [OwnFile(slug(place.stem), "own", place)]
    try:
        paths = sorted(place.glob(pattern))
    except (ValueError, NotImplementedError) as error:
        raise BadParams(f"parts.pattern: {pattern!r}: {error}") from None
    files = [path for path in paths if is_cad(path, place)]
    if not files:
        raise BadParams(
            f"parts.path: no file in {place} matches parts.pattern {pattern!r} and ends in "
            f"{', '.join(sorted(SUFFIXES))}"
        )
    found = [
        OwnFile(file_id, path.parent.name if path.parent != place else "own", path)
        for file_id, path in zip(file_ids(place, files), files, strict=True)
    ]
    wanted = _wanted(select, {file.file_id for file in found})
    return [file for file in found if not select or file.file_id in wanted]


def require_place(place: Path) -> None:
    """Raise BadParams unless there is a folder or a file at `place`."""
    if place.exists():
        return
    text = str(place)
    stars = [i for i, part in enumerate(place.parts) if re.search(r"[*?\[]", part)]
    if stars:  # DVC watches one path, so the folder and the pattern stand apart
        folder, pattern = Path(*place.parts[: stars[0]]), Path(*place.parts[stars[0] :])
        raise BadParams(
            f"params.yaml: parts.path {text!r} is a pattern; write path: {folder} and "
            f'pattern: "{pattern}"'
        )
    raise BadParams(f"params.yaml: parts.path {text!r} is neither a folder nor a file")


def file_ids(folder: Path, files: list[Path]) -> list[str]:
    """An id for every file: its path below `folder`, and its type where that alone tells two apart.

    Raises BadParams if two files would still share an id.
    """
    plain = [slug(str(path.relative_to(folder).with_suffix(""))) for path in files]
    often = Counter(plain)
    ids = [
        name if often[name] == 1 else f"{name}-{path.suffix[1:].lower()}"
        for name, path in zip(plain, files, strict=True)
    ]
    twice = [name for name, count in Counter(ids).items() if count > 1]
    if twice:
        named = [str(path) for name, path in zip(ids, files, strict=True) if name == twice[0]]
        raise BadParams(f"parts.path: {' and '.join(named)} share the id {twice[0]!r}; rename one")
    return ids


def slug(text: str) -> str:
    """`text` in lower case letters, digits and dashes."""
    return re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-") or "part"


def solid_slugs(names: Sequence[str]) -> list[str]:
    """A short name for every solid of a file; equal ones get their place in the file."""
    plain = [slug(re.sub(r"^solid (?=\d+$)", "", name)) for name in names]
    often = Counter(plain)
    several = [name if often[name] == 1 else f"{name}-{i}" for i, name in enumerate(plain, start=1)]
    distinct = len(set(several)) == len(several)
    return several if distinct else [str(i) for i in range(1, len(names) + 1)]


def is_cad(path: Path, place: Path) -> bool:
    """Whether `path` is a file of a type that is read, and not hidden, nor in a hidden folder."""
    below = path.relative_to(place).parts
    hidden = any(name.startswith(".") and name != ".." for name in below)
    return not hidden and path.suffix.lower() in SUFFIXES and path.is_file()


def _wanted(select: Sequence[str], file_ids: set[str]) -> set[str]:
    """The files that `select` names, or of which it may name a solid."""
    files, others = file_ids & set(select), set(select) - file_ids
    return files | {name for name in file_ids if any(o.startswith(f"{name}-") for o in others)}
