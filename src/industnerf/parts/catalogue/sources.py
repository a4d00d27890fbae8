"""Where parts come from: the embedded catalogue, or the user's own files.

Own files become parts in two steps.  `solids` reads each file once; `parts` repairs what was read,
whole or one part per solid, so that other repair settings never read a file again.
"""

from collections import Counter
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from industnerf.artifacts.solids import solid_names
from industnerf.errors import BadParams
from industnerf.parts.catalogue.entries import (
    CatalogueEntry,
    install_catalogue_part,
    read_catalogue,
)
from industnerf.parts.io.cad_files import CadFile, find_cad_files, solid_slugs
from industnerf.parts.io.ingest import ingest


@dataclass(frozen=True)
class PartTask:
    """One part to be: how to make it, and all that it depends on."""

    part_id: str
    make: "partial[None]"
    settings: Any
    files: tuple[Path, ...]


def embedded_parts(folder: Path, select: list[str]) -> list[PartTask]:
    """The embedded parts that params.yaml asks for, by id.

    Raises BadParams if the folder holds no catalogue, or lacks a part that `select` names.
    """
    if not (folder / "catalogue.json").exists():
        raise BadParams(
            f"parts.path: {folder} holds no catalogue.json; for files of your own set "
            "parts.source: path"
        )

    def part_task(entry: CatalogueEntry) -> PartTask:
        make = partial(install_catalogue_part, folder, entry)
        return PartTask(entry.id, make, entry, (folder / f"{entry.id}.npz",))

    tasks = {entry.id: part_task(entry) for entry in read_catalogue(folder)}
    for part_id in select:
        if part_id not in tasks:
            raise BadParams(f"parts.select: {part_id!r} is not among {', '.join(sorted(tasks))}")
    return [tasks[part_id] for part_id in sorted(tasks) if not select or part_id in select]


def user_parts(root: Path, solids: Path, read_ids: set[str], parts: Any) -> list[PartTask]:
    """The parts in the files of ids `read_ids`, which the stage `solids` has read into `solids`.

    `parts` has the keys pattern, select, split_bodies and repair of params.yaml.  Raises BadParams
    if two parts would share an id, or `select` names one that is neither a part nor a file.
    """
    files = find_cad_files(root, parts.pattern, [])
    tasks = [
        task
        for file in files
        if file.file_id in read_ids
        for task in _parts_of(file, solids / file.file_id, parts)
    ]
    ids = Counter(task.part_id for task in tasks)
    selected_ids = {file.file_id for file in find_cad_files(root, parts.pattern, parts.select)}
    ids.update(selected_ids - read_ids)  # what could not be read failed by this name
    duplicates = [part_id for part_id, count in ids.items() if count > 1]
    if duplicates:
        raise BadParams(f"parts.path: two parts share the id {duplicates[0]!r}; rename a file")
    known_ids = {file.file_id for file in files} | set(ids)
    for name in parts.select:
        if name not in known_ids:
            raise BadParams(f"parts.select: {name!r} is not among {', '.join(sorted(known_ids))}")
    return tasks


def _parts_of(file: CadFile, folder: Path, parts: Any) -> list[PartTask]:
    """The parts of one file: itself, or its solids; those that `parts.select` names."""
    names = solid_names(folder)
    solid_indices: dict[str, int | None] = {file.file_id: None}
    if parts.split_bodies and len(names) > 1:
        solid_indices = {f"{file.file_id}-{name}": i for i, name in enumerate(solid_slugs(names))}

    def part_task(part_id: str, solid_index: int | None) -> PartTask:
        make = partial(ingest, folder, part_id, file.family, solid_index, parts.repair)
        settings = [part_id, file.family, solid_index, parts.repair]
        return PartTask(part_id, make, settings, (folder / "solids.json", folder / "solids.npz"))

    selected = set(parts.select)
    return [
        part_task(part_id, solid_index)
        for part_id, solid_index in solid_indices.items()
        if not selected or selected & {part_id, file.file_id}
    ]
