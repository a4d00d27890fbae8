"""`python -m industnerf.parts list` and `build`: a catalogue as a table, and built anew."""

from pathlib import Path
from tempfile import TemporaryDirectory

from rich.console import Console
from rich.progress import track
from rich.table import Table

from industnerf.errors import BadParams, BadPart
from industnerf.parts.catalogue.catalogues import catalogue_folder, load_families
from industnerf.parts.catalogue.entries import read_catalogue
from industnerf.parts.catalogue.part_builder import build_parts, read_draft, write_catalogue
from industnerf.runner import runner_from_environment


def build_catalogue(
    console: Console, name: str, family: str | None, folder: Path | None = None
) -> None:
    """Build the catalogue `name`, or one family, in its folder; if a part fails, write nothing."""
    families = load_families(name)
    if family is not None and family not in families:
        raise BadParams(f"--family: no family {family!r}, only {', '.join(families)}")
    selected = families if family is None else [family]
    part_ids = [recipe.id for name_of_family in selected for recipe in families[name_of_family]]
    folder = folder or catalogue_folder(name)
    unchanged = (
        [entry for entry in read_catalogue(folder) if entry.family != family] if family else []
    )
    with TemporaryDirectory() as drafts:
        outcomes = build_parts(name, part_ids, Path(drafts), runner_from_environment())
        results = list(track(outcomes, "Building", total=len(part_ids), console=console))
        failed = [
            f"{part_ids[outcome.index]}: {outcome.error}"
            for outcome in results
            if outcome.error is not None
        ]
        if failed:
            raise BadPart("\n".join([*failed, f"{len(failed)} parts failed; nothing was written"]))
        write_catalogue(
            [read_draft(Path(drafts), part_id) for part_id in part_ids], unchanged, folder
        )
    console.print(f"{len(part_ids)} parts built into {folder}")


def print_catalogue(console: Console, name: str) -> None:
    """Print the catalogue `name`, one row a part."""
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
