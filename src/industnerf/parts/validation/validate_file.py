"""One file in a process of its own: read, repaired, and reported.

<target>/findings.json    a finding for the file, or one for each of its solids
<target>/cost.json        seconds and memory
<target>/solids.*         the repaired meshes of those that are usable
"""

import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path

from industnerf.artifacts.files import write_json
from industnerf.artifacts.solids import Solid, Solids
from industnerf.capture.render import background_warning
from industnerf.errors import BadPart
from industnerf.parts.io.cad_files import solid_slugs
from industnerf.parts.io.readers import read_solids
from industnerf.parts.io.units import unit_note
from industnerf.parts.repair import repair_mesh
from industnerf.parts.validation import checks
from industnerf.schema import Params
from industnerf.stage import run_timed


@dataclass(frozen=True)
class Finding:
    """The verdict on a file, or on one of its solids."""

    file: str
    refused: str = ""  # why it cannot be a part; empty if it can
    solid: str = ""  # its name in part ids, where a file's solids are looked at one by one
    format: str = ""
    unit: str = ""
    solids: int = 0
    size_mm: tuple[float, ...] = ()
    area_mm2: float = 0.0
    volume_mm3: float | None = None  # None where the mesh is not closed
    bodies: int = 0
    faces: int = 0
    open_edges: int = 0
    back_face_share: float = 0.0
    repairs: tuple[str, ...] = ()
    residual_defects: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()  # likely mistakes that are no defects
    seconds: float = 0.0  # of the whole file
    peak_mb: float = 0.0

    @property
    def name(self) -> str:
        return f"{self.file}: {self.solid}" if self.solid else self.file

    @property
    def verdict(self) -> str:
        if self.refused:
            return "refused"
        return "usable with warnings" if self.residual_defects else "usable"


def validate_file(path: Path, params: Params, target: Path) -> None:
    """Write the findings, cost and repaired solids of the file at `path` into `target`.

    Raises BadPart if it cannot be read, or is looked at as a whole and cannot be a part.
    """
    target.mkdir(parents=True)
    cost = run_timed(partial(_validate, path, params), target)
    write_json(target / "cost.json", asdict(cost))


def load_findings(target: Path, file: str) -> list[Finding]:
    """The findings in the folder `target`; `file` is the name under which to report them."""
    rows, cost = (
        json.loads((target / n).read_text(encoding="utf-8")) for n in ("findings.json", "cost.json")
    )
    common = {"file": file, "seconds": cost["seconds"], "peak_mb": cost["peak_mb"]}
    return [Finding(**(_with_tuples(row) | common)) for row in rows]


def _with_tuples(row: dict) -> dict:
    return row | {
        key: tuple(row[key]) for key in ("size_mm", "repairs", "residual_defects", "notes")
    }


def _validate(path: Path, params: Params, target: Path) -> None:
    file = read_solids(path, params.parts.units, params.parts.override_units)
    split = params.parts.split_bodies and len(file.solids) > 1  # as the stage `parts` has it
    groups = [(solid,) for solid in file.solids] if split else [file.solids]
    results = list(_validate_solids(file, groups, split, params))
    usable = tuple(solid for _, solid in results if solid is not None)
    repaired = Solids(file.file, file.format, file.unit, file.finishes, file.warnings, usable)
    repaired.save(target)
    write_json(target / "findings.json", [asdict(finding) for finding, _ in results])


def _validate_solids(
    file: Solids, groups: Sequence[Sequence[Solid]], split: bool, params: Params
) -> Iterator[tuple[Finding, Solid | None]]:
    """A finding for each of `groups`, and the repaired mesh of those that can be a part."""
    names = solid_slugs([solid.name for solid in file.solids]) if split else [""]
    for name, group in zip(names, groups, strict=True):
        try:
            repaired = repair_mesh([solid.mesh for solid in group], params.parts.repair)
        except BadPart as refusal:
            if not split:
                raise
            yield Finding(file.file, str(refusal), name, file.format, file.unit, len(group)), None
            continue
        mesh = repaired.mesh
        size_mm = tuple(float(side) for side in checks.extents_mm(mesh.vertices))
        warning = background_warning(mesh, file.finishes, params.views, params.seed)
        is_closed = not len(checks.bad_edges(mesh.faces))
        finding = Finding(
            file=file.file,
            solid=name,
            format=file.format,
            unit=file.unit,
            solids=len(group),
            size_mm=size_mm,
            area_mm2=checks.area_mm2(mesh.vertices, mesh.faces),
            volume_mm3=checks.volume_mm3(mesh.vertices, mesh.faces) if is_closed else None,
            bodies=checks.count_bodies(mesh.faces),
            faces=len(mesh.faces),
            open_edges=repaired.open_edges,
            back_face_share=repaired.back_face_share,
            repairs=repaired.repairs,
            residual_defects=file.warnings + repaired.residual_defects,
            notes=tuple(filter(None, [unit_note(file.unit, max(size_mm)), warning])),
        )
        yield finding, Solid(name, mesh)
