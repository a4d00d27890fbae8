"""Which file is a cloud of which part."""

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

from industnerf.errors import BadParams
from industnerf.parts.catalogue import catalogue
from industnerf.parts.files import find_files
from industnerf.parts.reading.formats import SUFFIXES as CAD
from industnerf.parts.sets import FOLDERS
from industnerf.schema.parts import PartsParams

SUFFIXES = (".ply", ".npz", ".xyz", ".obj", ".stl", ".off")


def clouds_at(place: Path, part_id: str) -> dict[str, Path]:
    """The cloud of each part: the file `place`, of `part_id` or named after its part; or a folder.

    Raises BadParams if there is no cloud, if two are of one part, or if a folder is to be of one.
    """
    if not place.exists():
        raise BadParams(f"{place} does not exist; give a cloud, or a folder of clouds")
    if place.is_dir() and part_id:
        raise BadParams(
            f"{place} is a folder: its files are named after their parts, not {part_id}"
        )
    files = [place] if place.is_file() else shown_files(place)
    known = [path for path in files if path.suffix.lower() in SUFFIXES]
    if not known:
        raise BadParams(f"{place}: no file ends in {', '.join(SUFFIXES)}")
    clouds: dict[str, Path] = {}
    for path in known:
        name = part_id or path.stem
        if name in clouds:
            raise BadParams(f"{place}: {clouds[name].name} and {path.name} are of one part")
        clouds[name] = path
    return clouds


def shown_files(folder: Path) -> list[Path]:
    """The files in `folder`, but for hidden ones: macOS writes such beside each file."""
    return [p for p in sorted(folder.iterdir()) if p.is_file() and not p.name.startswith(".")]


def baked(parts: PartsParams, wanted: Iterable[str]) -> PartsParams:
    """`parts` set to those `wanted`, of the baked set that has them; else raises BadParams."""
    missing: dict[str, list[str]] = {}
    for name, folder in FOLDERS.items():
        known = {entry.id for entry in catalogue(folder)}
        missing[name] = sorted(set(wanted) - known)
        if not missing[name]:
            return replace(parts, source="embedded", path=str(folder), select=sorted(wanted))
    unknown = set.intersection(*map(set, missing.values()))
    if not unknown:
        raise BadParams(
            f"the clouds are of parts of several sets ({', '.join(FOLDERS)}), which are scored "
            "apart: give a folder for each"
        )
    fewest = min(missing, key=lambda name: len(missing[name]))
    raise BadParams(
        f"no part is called {min(unknown)!r}: name the cloud after its part, or give the "
        f"part's name or CAD file too; `python -m industnerf.parts list --set {fewest}`"
    )


def cad_file(part: str) -> Path | None:
    """The CAD file that `part` names, None if it is the id of a part.

    Raises BadParams if it looks like a path, by a slash or a suffix, and no file is there, or if
    it is a folder that no part is called after.
    """
    path = Path(part)
    if path.is_file():  # "" is the current folder
        return path
    folder = part and path.is_dir() and not _is_baked(part)
    if folder or "/" in part or path.suffix.lower() in CAD:
        what = "is a folder" if path.is_dir() else "does not exist"
        raise BadParams(f"{part} {what}; give one CAD file, or the name of a part of the suite")
    return None


def _is_baked(part: str) -> bool:
    return any(entry.id == part for folder in FOLDERS.values() for entry in catalogue(folder))


def own(parts: PartsParams, cad: Path) -> tuple[PartsParams, str]:
    """`parts` set to the one CAD file `cad`, and the id that the part will have."""
    (file,) = find_files(cad, "**/*", [])
    chosen = replace(
        parts, source="path", path=str(cad), pattern="**/*", select=[], split_bodies=False
    )
    return chosen, file.file_id
