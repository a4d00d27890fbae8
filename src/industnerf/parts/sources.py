"""Where parts come from: the embedded catalogue, or a folder of the user's own files."""

import re
from collections import Counter
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from industnerf.errors import BadParams
from industnerf.parts.catalogue import Entry, catalogue
from industnerf.parts.ingest import ingest_embedded, ingest_file
from industnerf.parts.read import SUFFIXES
from industnerf.schema import PartsParams


@dataclass(frozen=True)
class Source:
    """One part to be: how to make it, and all that it depends on."""

    part_id: str
    make: "partial[None]"
    settings: Any
    files: tuple[Path, ...]


def find_sources(folder: Path, settings: PartsParams, seed: int) -> list[Source]:
    """The parts that params.yaml asks for, by id.

    Raises BadParams if the folder is missing, holds no such file, or `parts.select` names a part
    that is not there.
    """
    if not folder.is_dir():
        raise BadParams(f"parts.path: {folder} is not a folder")
    find = {"embedded": _embedded, "path": _own}[settings.source]
    found = sorted(find(folder, settings, seed), key=lambda source: source.part_id)
    known = {source.part_id for source in found}
    for part_id in settings.select:
        if part_id not in known:
            raise BadParams(f"parts.select: {part_id!r} is not among {', '.join(sorted(known))}")
    return [source for source in found if not settings.select or source.part_id in settings.select]


def _embedded(folder: Path, settings: PartsParams, seed: int) -> list[Source]:
    if not (folder / "catalogue.json").exists():
        raise BadParams(
            f"parts.path: {folder} holds no catalogue.json; for files of your own set "
            "parts.source: path"
        )

    def source(entry: Entry) -> Source:
        make = partial(ingest_embedded, folder, entry, eyes=settings.eyes, seed=seed)
        return Source(entry.id, make, [entry, settings.eyes, seed], (folder / f"{entry.id}.npz",))

    return [source(entry) for entry in catalogue(folder)]


def _own(folder: Path, settings: PartsParams, seed: int) -> list[Source]:
    files = [p for p in sorted(folder.glob(settings.pattern)) if p.suffix.lower() in SUFFIXES]
    if not files:
        raise BadParams(
            f"parts.path: no file in {folder} matches parts.pattern {settings.pattern!r} and ends "
            f"in {', '.join(SUFFIXES)}"
        )

    def source(part_id: str, path: Path) -> Source:
        family = path.parent.name if path.parent != folder else "own"
        cleaning = {"units": settings.units, "weld": settings.weld, "eyes": settings.eyes}
        make = partial(ingest_file, path, part_id, family, seed=seed, **cleaning)
        return Source(part_id, make, [part_id, family, cleaning, seed], (path,))

    return [source(i, path) for i, path in zip(part_ids(folder, files), files, strict=True)]


def part_ids(folder: Path, files: list[Path]) -> list[str]:
    """An id for every file: its path below `folder`, and its type where that alone tells two apart.

    Raises BadParams if two files would still share an id.
    """
    plain = [_slug(str(path.relative_to(folder).with_suffix(""))) for path in files]
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


def _slug(text: str) -> str:
    return re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-") or "part"
