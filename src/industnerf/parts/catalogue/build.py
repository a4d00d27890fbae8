"""`python -m industnerf.parts list` and `build`: print a catalogue, and build it again."""

from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.progress import track
from rich.table import Table

from industnerf.errors import BadParams, BadPart
from industnerf.parts.catalogue.catalogues import catalogue_folder, load_families
from industnerf.parts.catalogue.entries import CatalogueEntry, read_catalogue
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


DROPPED_FIRST = ("drawn with", "bodies", "faces", "designation", "volume, cm³", "family")
ANY_WIDTH = 1000  # columns


def print_catalogue(console: Console, name: str) -> None:
    """Print the catalogue `name`, one row a part; no cell is cut or broken.

    A terminal that is too narrow shows fewer columns, a file or a pipe has all.
    """
    entries = read_catalogue(catalogue_folder(name))
    columns = catalogue_columns(entries)
    families = len(set(columns["family"]))
    title = f"{len(entries)} parts in {families} families"
    wide = console.options.update(max_width=ANY_WIDTH)
    for heading in ("", *DROPPED_FIRST):
        columns.pop(heading, None)
        table = _table(title, columns)
        width = console.measure(table, options=wide).maximum
        if width <= console.width or not console.is_terminal:
            break
    console.width = max(width, console.width)  # rather too wide than cut
    console.print(table)


def catalogue_columns(entries: Sequence[CatalogueEntry]) -> dict[str, list[str]]:
    """What `list` shows of each of `entries`, by heading."""
    measured = [entry.measured for entry in entries]
    sizes = [" x ".join(f"{side:.1f}" for side in part.extents_mm) for part in measured]
    return {
        "part": [entry.id for entry in entries],
        "designation": [entry.designation for entry in entries],
        "family": [entry.family for entry in entries],
        "drawn with": [entry.library for entry in entries],
        "size, mm": sizes,
        "volume, cm³": [f"{part.volume_mm3 / 1000:.2f}" for part in measured],
        "faces": [str(part.faces) for part in measured],
        "bodies": [str(part.bodies) for part in measured],
    }


def _table(title: str, columns: dict[str, list[str]]) -> Table:
    table = Table(title=title, box=SIMPLE_HEAD, padding=(0, 1, 0, 0))
    texts = ("part", "designation", "family", "drawn with")
    for heading in columns:
        justify = "left" if heading in texts else "right"
        table.add_column(heading, justify=justify, no_wrap=True)
    for row in zip(*columns.values(), strict=True):
        table.add_row(*row)
    return table
