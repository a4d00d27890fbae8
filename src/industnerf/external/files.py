"""Which file is a cloud of which part."""

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

from industnerf.errors import BadParams
from industnerf.external.converters import converter_hint
from industnerf.external.points import CLOUD_READERS, TEXT_SUFFIXES
from industnerf.external.xyz import looks_like_points
from industnerf.parts.catalogue.catalogues import CATALOGUE_FOLDERS
from industnerf.parts.catalogue.entries import read_catalogue
from industnerf.parts.io.cad_files import find_cad_files, name_files
from industnerf.parts.io.readers.formats import SUFFIXES as CAD
from industnerf.schema.parts import PartsParams
from industnerf.suggestions import did_you_mean

SUFFIXES = tuple(dict.fromkeys((".ply", *CLOUD_READERS, *CAD)))


def find_clouds(path: Path, part_id: str) -> dict[str, Path]:
    """The cloud of each part: the file `path`, of `part_id` or named after its part; or a folder.

    Raises BadParams if there is no cloud, if two are of one part, or if a folder is to be of one.
    """
    if not path.exists():
        raise BadParams(f"{path} does not exist; give a cloud, or a folder of clouds")
    if path.is_dir() and part_id:
        raise BadParams(f"{path} is a folder: its files are named after their parts, not {part_id}")
    if path.is_file() and (hint := converter_hint(path)):
        raise BadParams(f"{path}: {hint}")
    files = [path] if path.is_file() else visible_files(path)
    cloud_files = [file for file in files if _is_cloud(file, named=path.is_file())]
    others = [file for file in files if file not in cloud_files]
    hints = [f"{file.name}: {hint}" for file in others if (hint := converter_hint(file))]
    if not cloud_files:
        found = f"; it has {name_files(others)}" if path.is_dir() and others else ""
        raise BadParams(
            "\n".join([f"{path}: no file ends in {', '.join(SUFFIXES)}{found}", *hints])
        )
    if others:
        print(f"left out, for they are no clouds that are read: {name_files(others)}")
    for hint in hints:
        print(hint)
    clouds: dict[str, Path] = {}
    for file in cloud_files:
        name = part_id or file.stem
        if name in clouds:
            raise BadParams(f"{path}: {clouds[name].name} and {file.name} are of one part")
        clouds[name] = file
    return clouds


def _is_cloud(file: Path, named: bool) -> bool:
    """Whether `file` may be a cloud; text that the user did not name must begin with a point."""
    suffix = file.suffix.lower()
    if suffix in TEXT_SUFFIXES and suffix != ".xyz" and not named:
        return looks_like_points(file)
    return suffix in SUFFIXES


def visible_files(folder: Path) -> list[Path]:
    """The files in `folder`, but for hidden ones: macOS writes such beside each file."""
    return [p for p in sorted(folder.iterdir()) if p.is_file() and not p.name.startswith(".")]


def select_catalogue(parts: PartsParams, part_ids: Iterable[str]) -> PartsParams:
    """`parts` set to `part_ids`, of the embedded set that has them; else raises BadParams."""
    missing: dict[str, list[str]] = {}
    known: set[str] = set()
    for name, folder in CATALOGUE_FOLDERS.items():
        catalogue_ids = {entry.id for entry in read_catalogue(folder)}
        known |= catalogue_ids
        missing[name] = sorted(set(part_ids) - catalogue_ids)
        if not missing[name]:
            return replace(parts, source="embedded", path=str(folder), select=sorted(part_ids))
    unknown = set.intersection(*map(set, missing.values()))
    if not unknown:
        raise BadParams(
            f"the clouds are of parts of several sets ({', '.join(CATALOGUE_FOLDERS)}), which are "
            "scored apart: give a folder for each"
        )
    closest = min(missing, key=lambda name: len(missing[name]))
    name = min(unknown)
    advice = did_you_mean(name, known) or ":"
    raise BadParams(
        f"no part is called {name!r}{advice} name the cloud after its part, or give the "
        f"part's name or CAD file too; `python -m industnerf.parts list --set {closest}`"
    )


def cad_file(part: str) -> Path | None:
    """The CAD file that `part` names, None if it is the id of a part.

    Raises BadParams if it looks like a path, by a slash or a suffix, and no file is there, or if
    it is a folder that no part is called after.
    """
    path = Path(part)
    if path.is_file():  # "" is the current folder
        return path
    folder = part and path.is_dir() and not _is_catalogue_part(part)
    if folder or "/" in part or path.suffix.lower() in CAD:
        what = "is a folder" if path.is_dir() else "does not exist"
        raise BadParams(f"{part} {what}; give one CAD file, or the name of a part of the suite")
    return None


def _is_catalogue_part(part: str) -> bool:
    return any(
        entry.id == part
        for folder in CATALOGUE_FOLDERS.values()
        for entry in read_catalogue(folder)
    )


def user_cad(parts: PartsParams, cad: Path) -> tuple[PartsParams, str]:
    """`parts` set to the one CAD file `cad`, and the id that the part will have."""
    (file,) = find_cad_files(cad, "**/*", [])
    selected = replace(
        parts, source="path", path=str(cad), pattern="**/*", select=[], split_bodies=False
    )
    return selected, file.file_id
