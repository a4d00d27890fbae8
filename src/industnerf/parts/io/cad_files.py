"""The user's own files and their ids."""

import re
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from industnerf.errors import BadParams
from industnerf.parts.io.readers.formats import SUFFIXES
from industnerf.parts.io.readers.sidecars import find_sidecars

MAX_NAMED = 10  # of the files that are left out


@dataclass(frozen=True)
class CadFile:
    """One file, its id in the study, and its family: the folder it is in."""

    file_id: str
    family: str
    path: Path


def find_cad_files(root: Path, pattern: str, select: list[str]) -> list[CadFile]:
    """The CAD files at `root`: itself, or those in it that match `pattern`, by id.

    In a folder, unknown types are skipped, which `unread_files` names, as are hidden files and
    folders.  With `select`, only files that it names, or of which it names a solid.
    Raises BadParams if there is none, or if two would share an id.
    """
    require_path(root)
    if root.is_file():
        return [CadFile(slug(root.stem), "own", root)]
    try:
        paths = sorted(root.glob(pattern))
    except (ValueError, NotImplementedError) as error:
        raise BadParams(f"parts.pattern: {pattern!r}: {error}") from None
    files = [path for path in paths if is_cad_file(path, root)]
    if not files:
        raise BadParams(
            f"parts.path: no file in {root} matches parts.pattern {pattern!r} and ends in "
            f"{', '.join(sorted(SUFFIXES))}"
        )
    cad_files = [
        CadFile(file_id, path.parent.name if path.parent != root else "own", path)
        for file_id, path in zip(file_ids(root, files), files, strict=True)
    ]
    selected = _selected_ids(select, {file.file_id for file in cad_files})
    return [file for file in cad_files if not select or file.file_id in selected]


def require_path(path: Path) -> None:
    """Raise BadParams unless there is a folder or a file at `path`."""
    if path.exists():
        return
    text = str(path)
    wildcards = [i for i, part in enumerate(path.parts) if re.search(r"[*?\[]", part)]
    if wildcards:  # DVC watches one path, so the folder and the pattern stand apart
        folder, pattern = Path(*path.parts[: wildcards[0]]), Path(*path.parts[wildcards[0] :])
        raise BadParams(
            f"params.yaml: parts.path {text!r} is a pattern; write path: {folder} and "
            f'pattern: "{pattern}"'
        )
    raise BadParams(f"params.yaml: parts.path {text!r} is neither a folder nor a file")


def file_ids(folder: Path, files: list[Path]) -> list[str]:
    """An id for every file: its path below `folder`, and its type where that alone tells two apart.

    Raises BadParams if two files would still share an id.
    """
    slugs = [slug(str(path.relative_to(folder).with_suffix(""))) for path in files]
    counts = Counter(slugs)
    ids = [
        name if counts[name] == 1 else f"{name}-{path.suffix[1:].lower()}"
        for name, path in zip(slugs, files, strict=True)
    ]
    duplicates = [name for name, count in Counter(ids).items() if count > 1]
    if duplicates:
        duplicate_paths = [
            str(path) for name, path in zip(ids, files, strict=True) if name == duplicates[0]
        ]
        raise BadParams(
            f"parts.path: {' and '.join(duplicate_paths)} share the id {duplicates[0]!r}; "
            "rename one"
        )
    return ids


def slug(text: str) -> str:
    """`text` in lower case letters, digits and dashes."""
    return re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-") or "part"


def solid_slugs(names: Sequence[str]) -> list[str]:
    """A short name for every solid of a file; equal ones get their place in the file."""
    slugs = [slug(re.sub(r"^solid (?=\d+$)", "", name)) for name in names]
    counts = Counter(slugs)
    numbered = [
        name if counts[name] == 1 else f"{name}-{i}" for i, name in enumerate(slugs, start=1)
    ]
    is_unique = len(set(numbered)) == len(numbered)
    return numbered if is_unique else [str(i) for i in range(1, len(names) + 1)]


def is_cad_file(path: Path, root: Path) -> bool:
    """Whether `path` is a file of a type that is read, and not hidden, nor in a hidden folder."""
    return path.suffix.lower() in SUFFIXES and is_visible_file(path, root)


def is_visible_file(path: Path, root: Path) -> bool:
    """Whether `path` is a file, and not hidden, nor in a hidden folder below `root`."""
    parts_below = path.relative_to(root).parts
    is_hidden = any(name.startswith(".") and name != ".." for name in parts_below)
    return not is_hidden and path.is_file()


def unread_files(root: Path, paths: Iterable[Path]) -> list[Path]:
    """The visible files of `paths`, all below the folder `root`, that no reader opens.

    They are of no type that is read, and no CAD file among them names them as its sidecar.
    """
    files = [path for path in sorted(paths) if is_visible_file(path, root)]
    cad_files = [path for path in files if is_cad_file(path, root)]
    opened = set(cad_files)
    if len(cad_files) < len(files):
        opened.update(sidecar for path in cad_files for sidecar in find_sidecars(path.resolve()))
    return [path for path in files if path not in opened and path.resolve() not in opened]


def print_unread_files(label: str, root: Path, paths: Iterable[Path]) -> None:
    """Print a line that names `unread_files`, if there are any."""
    if unread := unread_files(root, paths):
        print(f"{label}: left out, for they are no CAD: {name_files(unread)}")


def name_files(paths: Sequence[Path]) -> str:
    """The names of the first MAX_NAMED of `paths`, and how many more there are."""
    more = len(paths) - MAX_NAMED
    names = ", ".join(path.name for path in paths[:MAX_NAMED])
    return f"{names} and {more} more" if more > 0 else names


def _selected_ids(select: Sequence[str], file_ids: set[str]) -> set[str]:
    """The files that `select` names, or of which it may name a solid."""
    files, solid_names = file_ids & set(select), set(select) - file_ids
    return files | {
        name
        for name in file_ids
        if any(solid_name.startswith(f"{name}-") for solid_name in solid_names)
    }
