"""`python -m industnerf.parts build`: draw, check and bake a set, or one family of it, anew."""

from pathlib import Path
from tempfile import TemporaryDirectory

from rich.console import Console
from rich.progress import track

from industnerf.errors import BadParams, BadPart
from industnerf.parts.bake import bake_all, read_draft, write
from industnerf.parts.catalogue import catalogue
from industnerf.parts.sets import families_of, folder_of
from industnerf.runner import runner_from_environment


def build(console: Console, name: str, family: str | None, folder: Path | None = None) -> None:
    """Bake the set `name`, or one family of it, into its folder; if a part fails, write nothing."""
    families = families_of(name)
    if family is not None and family not in families:
        raise BadParams(f"--family: no family {family!r}, only {', '.join(families)}")
    chosen = families if family is None else [family]
    part_ids = [drawable.id for key in chosen for drawable in families[key]]
    folder = folder or folder_of(name)
    kept = [entry for entry in catalogue(folder) if entry.family != family] if family else []
    with TemporaryDirectory() as drafts:
        outcomes = bake_all(name, part_ids, Path(drafts), runner_from_environment())
        done = list(track(outcomes, "Baking", total=len(part_ids), console=console))
        failed = [f"{part_ids[one.index]}: {one.error}" for one in done if one.error is not None]
        if failed:
            raise BadPart("\n".join([*failed, f"{len(failed)} parts failed; nothing was written"]))
        write([read_draft(Path(drafts), part_id) for part_id in part_ids], kept, folder)
    console.print(f"{len(part_ids)} parts baked into {folder}")
