"""Files that a CAD file names: materials, pictures, buffers.

A sidecar is a file in the folder of the CAD file, or below, of a type in SIDECAR_SUFFIXES, that the
text names.  Readers open no other, so a result depends on the file and on its sidecars alone.
"""

import html
import json
import re
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import unquote

from industnerf.errors import BadPart
from industnerf.parts.io.readers import formats
from industnerf.parts.io.readers.formats import decode_text, detect_format

OWNER_FORMATS = (
    formats.OBJ,
    formats.GLTF,
    formats.GLB,
    formats.DAE,
)  # whose readers open other files
SIDECAR_SUFFIXES = ("mtl", "bin", "png", "jpg", "jpeg", "bmp", "tga", "gif", "tif", "tiff", "webp")
SUFFIX_PATTERN = re.compile(rf"\.(?:{'|'.join(SIDECAR_SUFFIXES)})\b", re.I)
NAME_DELIMITERS = re.compile(
    r"[\r\n\"<>]"
)  # what stands around names; none that holds one is looked for
MAX_NAME_CHARS = 2000  # characters of a name with its folders, escaped


def find_sidecars(path: Path) -> tuple[Path, ...]:
    """The files that `path` names and that are there, and those that its materials name."""
    if not path.is_file() or not _is_owner(path):
        return ()
    paths = set(_iter_sidecars(path))
    for library in [sidecar for sidecar in paths if sidecar.suffix.lower() == ".mtl"]:
        paths.update(_iter_sidecars(library))
    return tuple(sorted(paths - {path}))


def resolve_sidecar(path: Path, text: str) -> Path | None:
    """The file that `text` means in the file at `path`, or None if there is none below its folder.

    Names may hold blanks and stand behind options, so the longest tail that names a file counts.
    """
    tokens = unquote(text.replace("\\", "/")).strip().removeprefix("file:///").split(" ")
    folder = path.parent.resolve()
    for i in range(len(tokens)):
        name = " ".join(tokens[i:]).strip()
        for candidate in (name, name.rpartition("/")[2]):
            if NAME_DELIMITERS.search(candidate) is None and _is_sidecar(
                folder / candidate, folder
            ):
                return folder / candidate
    return None


def _is_owner(path: Path) -> bool:
    try:
        return detect_format(path)[0] in OWNER_FORMATS
    except BadPart:
        return False


def _iter_sidecars(path: Path) -> Iterator[Path]:
    """The sidecars that the text at `path` may mean, whichever of the formats it is in."""
    text = decode_text(path.read_bytes())
    ends = [match.end() for match in SUFFIX_PATTERN.finditer(text)]
    for name in {
        NAME_DELIMITERS.split(text[max(end - MAX_NAME_CHARS, 0) : end])[-1] for end in ends
    }:
        for candidate in {
            name,
            " ".join(name.split()),
            html.unescape(name),
            _without_escapes(name),
        }:
            sidecar = resolve_sidecar(path, candidate)
            if sidecar is not None:
                yield sidecar


def _without_escapes(name: str) -> str:
    """What JSON means by `name`."""
    try:
        return json.loads(f'"{name}"')
    except ValueError:
        return name


def _is_sidecar(path: Path, folder: Path) -> bool:
    try:
        is_file = path.suffix[1:].lower() in SIDECAR_SUFFIXES and path.is_file()
        return is_file and folder in path.resolve().parents
    except (OSError, ValueError):  # too long a name, or one with a character that none can have
        return False
