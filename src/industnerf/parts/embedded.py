"""One baked part to a part folder."""

from pathlib import Path

from industnerf.artifacts.part import Part, save_part
from industnerf.parts.catalogue import Entry, load


def place_embedded(folder: Path, entry: Entry, target: Path) -> None:
    """Write the part folder of a baked part; raises BadPart or BadArtifact if it is not sound."""
    save_part(target, as_part(entry), load(entry, folder))


def as_part(entry: Entry) -> Part:
    """What `part.json` says of a baked part."""
    return Part(
        part_id=entry.id,
        family=entry.family,
        designation=entry.designation,
        origin=entry.origin,
        source=entry.library,
        finishes=entry.finishes,
        defects=(),
        **vars(entry.measured),
    )
