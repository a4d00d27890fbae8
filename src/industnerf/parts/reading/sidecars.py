"""Files that a CAD file names: materials, pictures, buffers.

A sidecar is a file in the folder of the CAD file, or below, of one of the types `TYPES`, that the
text names.  Readers open no other, so a result depends on the file and on its sidecars alone.
"""

import html
import json
import re
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import unquote

from industnerf.errors import BadPart
from industnerf.parts.reading import formats
from industnerf.parts.reading.formats import recognise, text_of

OWNERS = (formats.OBJ, formats.GLTF, formats.GLB, formats.DAE)  # whose readers open other files
TYPES = ("mtl", "bin", "png", "jpg", "jpeg", "bmp", "tga", "gif", "tif", "tiff", "webp")
ENDING = re.compile(rf"\.(?:{'|'.join(TYPES)})\b", re.I)
BOUNDS = re.compile(r"[\r\n\"<>]")  # what stands around names; none that holds one is looked for
LONGEST = 2000  # characters of a name with its folders, escaped


def sidecars(path: Path) -> tuple[Path, ...]:
    """The files that `path` names and that are there, and those that its materials name."""
    if not path.is_file() or not _is_owner(path):
        return ()
    found = set(_named_in(path))
    for library in [beside for beside in found if beside.suffix.lower() == ".mtl"]:
        found.update(_named_in(library))
    return tuple(sorted(found - {path}))


def named(path: Path, text: str) -> Path | None:
    """The file that `text` means in the file at `path`, or None if there is none below its folder.

    Names may hold blanks and stand behind options, so the longest tail that names a file counts.
    """
    words = unquote(text.replace("\\", "/")).strip().removeprefix("file:///").split(" ")
    folder = path.parent.resolve()
    for i in range(len(words)):
        name = " ".join(words[i:]).strip()
        for place in (name, name.rpartition("/")[2]):
            if BOUNDS.search(place) is None and _is_sidecar(folder / place, folder):
                return folder / place
    return None


def _is_owner(path: Path) -> bool:
    try:
        return recognise(path)[0] in OWNERS
    except BadPart:
        return False


def _named_in(path: Path) -> Iterator[Path]:
    """The sidecars that the text at `path` may mean, whichever of the formats it is in."""
    text = text_of(path.read_bytes())
    ends = [match.end() for match in ENDING.finditer(text)]
    for name in {BOUNDS.split(text[max(end - LONGEST, 0) : end])[-1] for end in ends}:
        for meant in {name, " ".join(name.split()), html.unescape(name), _without_escapes(name)}:
            beside = named(path, meant)
            if beside is not None:
                yield beside


def _without_escapes(name: str) -> str:
    """What JSON means by `name`."""
    try:
        return json.loads(f'"{name}"')
    except ValueError:
        return name


def _is_sidecar(path: Path, folder: Path) -> bool:
    try:
        there = path.suffix[1:].lower() in TYPES and path.is_file()
        return there and folder in path.resolve().parents
    except (OSError, ValueError):  # too long a name, or one with a character that none can have
        return False
