"""Files that a CAD file names: materials, pictures, buffers.

A sidecar is a file in the folder of the CAD file, or below, of one of the types `TYPES`, that the
text names.  Readers open no other, so a result depends on the file and on its sidecars alone.
"""

import re
from pathlib import Path
from urllib.parse import unquote

from industnerf.parts.reading.formats import text_of

OWNERS = (".obj", ".gltf", ".glb", ".dae", ".ply", ".mtl")  # that may name other files
TYPES = ("mtl", "bin", "png", "jpg", "jpeg", "bmp", "tga", "gif", "tif", "tiff", "webp")
NAMED = re.compile(rf"[^\r\n\t\"'<>|?*]{{1,250}}\.(?:{'|'.join(TYPES)})\b", re.I)


def sidecars(path: Path) -> tuple[Path, ...]:
    """The files that `path` names and that are there, and those that its materials name."""
    if path.suffix.lower() not in OWNERS or not path.is_file():
        return ()
    found: dict[Path, None] = {}
    for text in set(NAMED.findall(text_of(path.read_bytes()))):
        beside = named(path, text)
        if beside is not None and beside != path:
            found[beside] = None
            if beside.suffix.lower() == ".mtl" and path.suffix.lower() != ".mtl":
                found |= dict.fromkeys(sidecars(beside))
    return tuple(sorted(found))


def named(path: Path, text: str) -> Path | None:
    """The file that `text` means in the file at `path`, or None if there is none below its folder.

    Names may hold blanks and stand behind options, so the longest tail that names a file counts.
    """
    words = unquote(text.replace("\\", "/")).removeprefix("file:///").split(" ")
    folder = path.parent.resolve()
    for i in range(len(words)):
        name = " ".join(words[i:]).strip()
        for place in (name, name.rpartition("/")[2]):
            beside = folder / place
            if not _is_sidecar(beside):
                continue
            if folder in beside.resolve().parents and beside.is_file():
                return beside
    return None


def _is_sidecar(path: Path) -> bool:
    return path.suffix[1:].lower() in TYPES
