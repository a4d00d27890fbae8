"""One baked part to a part folder."""

from pathlib import Path

from industnerf.artifacts.part import Part, save_part
from industnerf.parts.catalogue.entries import CatalogueEntry, load_catalogue_mesh


def install_catalogue_part(folder: Path, entry: CatalogueEntry, target: Path) -> None:
    """Write the part folder of a baked part; raises BadPart or BadArtifact if it is not sound."""
    save_part(target, to_part(entry), load_catalogue_mesh(entry, folder))


def to_part(entry: CatalogueEntry) -> Part:
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
