"""`python -m industnerf.parts build`: draw, check and bake a set, or one family of it, anew."""

from pathlib import Path
from tempfile import TemporaryDirectory

from rich.console import Console
from rich.progress import track

from industnerf.errors import BadParams, BadPart
from industnerf.parts.catalogue.catalogues import catalogue_folder, load_families
from industnerf.parts.catalogue.entries import read_catalogue
from industnerf.parts.catalogue.part_builder import build_parts, read_draft, write_catalogue
from industnerf.runner import runner_from_environment


def build_catalogue(
    console: Console, name: str, family: str | None, folder: Path | None = None
) -> None:
    """Bake the set `name`, or one family of it, into its folder; if a part fails, write nothing."""
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
        results = list(track(outcomes, "Baking", total=len(part_ids), console=console))
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
    console.print(f"{len(part_ids)} parts baked into {folder}")
