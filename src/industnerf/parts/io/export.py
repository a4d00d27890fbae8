"""`python -m industnerf.parts export`: parts as files for other programs.

Triangles come from the stored mesh.  STEP is the exact drawing where there is one; else it is the
mesh in flat facets, and its name says so: `<part>-faceted.step`.
"""

from collections.abc import Callable, Sequence
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory

from rich.console import Console
from rich.progress import track

from industnerf.artifacts.part import Appearance, Mesh
from industnerf.errors import BadParams, PartsFailed, SuiteError
from industnerf.parts.catalogue.catalogues import catalogue_folder, find_recipe
from industnerf.parts.catalogue.entries import CatalogueEntry, load_catalogue_mesh, read_catalogue
from industnerf.runner import WorkResult, runner_from_environment

FORMATS = ("step", "stl", "glb", "ply", "obj")
TIMEOUT_S = 300.0  # for one part; the slowest drawing takes about 20 s


def export(
    console: Console, name: str, part_ids: Sequence[str] | None, file_format: str, out: Path
) -> None:
    """Write parts of the catalogue `name`, or all of them, into the folder `out`.

    Raises BadParams if a part is unknown, a file is there already or `out` cannot be a folder, and
    PartsFailed if some could not be written; the others are.
    """
    entries = _select_entries(name, part_ids)
    if file_format == "step" and find_spec("OCP") is None:
        raise SuiteError("STEP needs the CAD libraries: `pip install -e '.[cad]'`")
    _require_absent([path for entry in entries for path in _paths(out, entry.id, file_format)])
    _make_folder(out)
    works = [partial(export_part, name, entry, file_format, out) for entry in entries]
    outcomes = runner_from_environment().map(works, TIMEOUT_S)
    results = list(track(outcomes, "Exporting", total=len(works), console=console))
    _report(console, entries, results, file_format, out)


def _select_entries(name: str, part_ids: Sequence[str] | None) -> list[CatalogueEntry]:
    entries = {entry.id: entry for entry in read_catalogue(catalogue_folder(name))}
    for part_id in part_ids or ():
        if part_id not in entries:
            raise BadParams(
                f"export: no part {part_id!r} in the set {name!r}; "
                f"`python -m industnerf.parts list --set {name}` names them"
            )
    return [entries[part_id] for part_id in dict.fromkeys(part_ids or entries)]


def _path(out: Path, part_id: str, file_format: str, faceted: bool) -> Path:
    return out / f"{part_id}{'-faceted' if faceted else ''}.{file_format}"


def _paths(out: Path, part_id: str, file_format: str) -> list[Path]:
    """All files that may be written for one part."""
    paths = [_path(out, part_id, file_format, faceted) for faceted in (False, True)]
    return [*paths, paths[0].with_suffix(".mtl")] if file_format == "obj" else paths


def _require_absent(paths: list[Path]) -> None:
    existing = [path for path in paths if path.exists()]
    if existing:
        raise BadParams(
            f"export: {existing[0]} is there already, {len(existing)} files in all; remove them, "
            "or give another --out"
        )


def _make_folder(out: Path) -> None:
    try:
        out.mkdir(parents=True, exist_ok=True)
    except FileExistsError:
        raise BadParams(f"export: --out {out} is a file; give a folder for the parts") from None
    except OSError as error:  # a file above it, a disk that is full or may not be written to
        raise BadParams(f"export: --out {out} cannot be made: {error.strerror}") from None


def _report(
    console: Console,
    entries: list[CatalogueEntry],
    outcomes: list[WorkResult],
    file_format: str,
    out: Path,
) -> None:
    failed = [
        f"{entries[outcome.index].id}: {outcome.error}"
        for outcome in outcomes
        if outcome.error is not None
    ]
    faceted = [entry.id for entry in entries if _path(out, entry.id, file_format, True).exists()]
    console.print(f"{len(entries) - len(failed)} parts written to {out}", markup=False)
    if faceted:
        console.print(f"{len(faceted)} faceted, having no exact drawing: {', '.join(faceted)}")
    if failed:
        raise PartsFailed("\n".join([*failed, f"{len(failed)} parts could not be exported"]))


def export_part(name: str, entry: CatalogueEntry, file_format: str, out: Path) -> None:
    """Write one part; its files appear whole or not at all."""
    with TemporaryDirectory(prefix=".", dir=out) as temporary:
        _write(name, entry, file_format, Path(temporary))
        for path in Path(temporary).iterdir():
            path.replace(out / path.name)


def _write(name: str, entry: CatalogueEntry, file_format: str, folder: Path) -> None:
    mesh = load_catalogue_mesh(entry, catalogue_folder(name))
    path = _path(folder, entry.id, file_format, False)
    if file_format != "step":
        _writer(file_format)(path, mesh, entry.finishes)
        return
    from industnerf.parts.io.writers.step import write_drawing, write_faceted

    # Only the CAD kernel's recipes have a drawing; whether it is exact shows when it is made.
    drawing = None if name == "organic" else find_recipe(name, entry.id)[1].exact_drawing()
    if drawing is None:
        write_faceted(_path(folder, entry.id, file_format, True), mesh, entry.finishes)
    else:
        write_drawing(path, drawing)


def _writer(file_format: str) -> Callable[[Path, Mesh, tuple[Appearance, ...]], None]:
    from industnerf.parts.io.writers.mesh_formats import (
        write_face_ply,
        write_glb,
        write_obj,
        write_stl,
    )

    return {"stl": write_stl, "glb": write_glb, "ply": write_face_ply, "obj": write_obj}[
        file_format
    ]
