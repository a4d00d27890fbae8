"""Where parts come from: the embedded catalogue, or the user's own files.

Own files become parts in two steps.  `solids` reads each file once; `parts` cleans what was read,
whole or one part per solid, so that another way of cleaning never reads a file again.
"""

from collections import Counter
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from industnerf.artifacts.solids import names_of
from industnerf.errors import BadParams
from industnerf.parts.catalogue import Entry, catalogue
from industnerf.parts.embedded import place_embedded
from industnerf.parts.files import OwnFile, find_files, solid_slugs
from industnerf.parts.ingest import ingest


@dataclass(frozen=True)
class Source:
    """One part to be: how to make it, and all that it depends on."""

    part_id: str
    make: "partial[None]"
    settings: Any
    files: tuple[Path, ...]


def embedded_parts(folder: Path, select: list[str]) -> list[Source]:
    """The baked parts that params.yaml asks for, by id.

    Raises BadParams if the folder holds no catalogue, or lacks a part that `select` names.
    """
    if not (folder / "catalogue.json").exists():
        raise BadParams(
            f"parts.path: {folder} holds no catalogue.json; for files of your own set "
            "parts.source: path"
        )

    def source(entry: Entry) -> Source:
        make = partial(place_embedded, folder, entry)
        return Source(entry.id, make, entry, (folder / f"{entry.id}.npz",))

    found = {entry.id: source(entry) for entry in catalogue(folder)}
    for part_id in select:
        if part_id not in found:
            raise BadParams(f"parts.select: {part_id!r} is not among {', '.join(sorted(found))}")
    return [found[part_id] for part_id in sorted(found) if not select or part_id in select]


def own_parts(place: Path, solids: Path, read: set[str], parts: Any) -> list[Source]:
    """The parts in the files of ids `read`, which the stage `solids` has read into `solids`.

    `parts` has the keys pattern, select, split_bodies and clean of params.yaml.  Raises BadParams
    if two parts would share an id, or `select` names one that is neither a part nor a file.
    """
    files = find_files(place, parts.pattern, [])
    found = [
        source
        for file in files
        if file.file_id in read
        for source in _parts_of(file, solids / file.file_id, parts)
    ]
    ids = Counter(source.part_id for source in found)
    asked = {file.file_id for file in find_files(place, parts.pattern, parts.select)}
    ids.update(asked - read)  # what could not be read failed by this name
    twice = [part_id for part_id, count in ids.items() if count > 1]
    if twice:
        raise BadParams(f"parts.path: two parts share the id {twice[0]!r}; rename a file")
    known = {file.file_id for file in files} | set(ids)
    for name in parts.select:
        if name not in known:
            raise BadParams(f"parts.select: {name!r} is not among {', '.join(sorted(known))}")
    return found


def _parts_of(file: OwnFile, folder: Path, parts: Any) -> list[Source]:
    """The parts of one file: itself, or its solids; those that `parts.select` names."""
    names = names_of(folder)
    places: dict[str, int | None] = {file.file_id: None}
    if parts.split_bodies and len(names) > 1:
        places = {f"{file.file_id}-{name}": i for i, name in enumerate(solid_slugs(names))}

    def source(part_id: str, which: int | None) -> Source:
        make = partial(ingest, folder, part_id, file.family, which, parts.clean)
        settings = [part_id, file.family, which, parts.clean]
        return Source(part_id, make, settings, (folder / "solids.json", folder / "solids.npz"))

    wanted = set(parts.select)
    return [
        source(part_id, which)
        for part_id, which in places.items()
        if not wanted or wanted & {part_id, file.file_id}
    ]
