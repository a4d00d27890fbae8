"""`python -m industnerf.parts list`: a baked set as a table."""

from rich.console import Console
from rich.table import Table

from industnerf.parts.catalogue.catalogues import catalogue_folder
from industnerf.parts.catalogue.entries import read_catalogue


def print_catalogue(console: Console, name: str) -> None:
    """Print the set `name`, one row a part."""
    entries = read_catalogue(catalogue_folder(name))
    families = {entry.family for entry in entries}
    table = Table(title=f"{len(entries)} parts in {len(families)} families")
    for heading in ("part", "designation", "family", "drawn with"):
        table.add_column(heading)
    for heading in ("size, mm", "volume, cm³", "faces", "bodies"):
        table.add_column(heading, justify="right")
    for entry in entries:
        properties = entry.measured
        size = " x ".join(f"{side:.1f}" for side in properties.extents_mm)
        counts = (
            f"{properties.volume_mm3 / 1000:.2f}",
            str(properties.faces),
            str(properties.bodies),
        )
        table.add_row(entry.id, entry.designation, entry.family, entry.library, size, *counts)
    console.print(table)
