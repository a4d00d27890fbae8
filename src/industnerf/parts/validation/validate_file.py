"""One file looked at by itself, in a process that it may take down: read, repaired, and reported.

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
from industnerf.errors import BadPart
from industnerf.parts.io.cad_files import solid_slugs
from industnerf.parts.io.readers import read_solids
from industnerf.parts.io.units import unit_note
from industnerf.parts.repair import repair_mesh
from industnerf.parts.validation.checks import extents_mm
from industnerf.schema import RepairParams
from industnerf.stage import run_timed


@dataclass(frozen=True)
class Finding:
    """What there is to say of a file, or of one solid of it."""

    file: str
    refused: str = ""  # why it cannot be a part; empty if it can
    solid: str = ""  # its name in part ids, where a file's solids are looked at one by one
    format: str = ""
    unit: str = ""
    solids: int = 0
    size_mm: tuple[float, ...] = ()
    faces: int = 0
    open_edges: int = 0
    back_face_share: float = 0.0
    repairs: tuple[str, ...] = ()
    residual_defects: tuple[str, ...] = ()
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

    @property
    def note(self) -> str:
        """What is no fault, but may be a mistake; mostly empty."""
        return unit_note(self.unit, max(self.size_mm)) if self.size_mm else ""


def validate_file(
    path: Path, units: str, split: bool, settings: RepairParams, target: Path
) -> None:
    """Fill the folder `target` with what becomes of the file at `path`.

    Raises BadPart if it cannot be read, or is looked at as a whole and cannot be a part.
    """
    target.mkdir(parents=True)
    cost = run_timed(partial(_validate, path, units, split, settings), target)
    write_json(target / "cost.json", asdict(cost))


def load_findings(target: Path, file: str) -> list[Finding]:
    """The findings in the folder `target`; `file` is the name under which to report them."""
    rows, cost = (
        json.loads((target / n).read_text(encoding="utf-8")) for n in ("findings.json", "cost.json")
    )
    common = {"file": file, "seconds": cost["seconds"], "peak_mb": cost["peak_mb"]}
    return [Finding(**(_with_tuples(row) | common)) for row in rows]


def _with_tuples(row: dict) -> dict:
    return row | {key: tuple(row[key]) for key in ("size_mm", "repairs", "residual_defects")}


def _validate(path: Path, units: str, split: bool, settings: RepairParams, target: Path) -> None:
    file = read_solids(path, units)
    split = split and len(file.solids) > 1  # as the stage `parts` has it
    groups = [(solid,) for solid in file.solids] if split else [file.solids]
    results = list(_validate_solids(file, groups, split, settings))
    usable = tuple(solid for _, solid in results if solid is not None)
    repaired = Solids(file.file, file.format, file.unit, file.finishes, file.warnings, usable)
    repaired.save(target)
    write_json(target / "findings.json", [asdict(finding) for finding, _ in results])


def _validate_solids(
    file: Solids, groups: Sequence[Sequence[Solid]], split: bool, settings: RepairParams
) -> Iterator[tuple[Finding, Solid | None]]:
    """A finding for each of `groups`, and the repaired mesh of those that can be a part."""
    names = solid_slugs([solid.name for solid in file.solids]) if split else [""]
    for name, group in zip(names, groups, strict=True):
        try:
            repaired = repair_mesh([solid.mesh for solid in group], settings)
        except BadPart as refusal:
            if not split:
                raise
            yield Finding(file.file, str(refusal), name, file.format, file.unit, len(group)), None
            continue
        finding = Finding(
            file=file.file,
            solid=name,
            format=file.format,
            unit=file.unit,
            solids=len(group),
            size_mm=tuple(float(side) for side in extents_mm(repaired.mesh.vertices)),
            faces=len(repaired.mesh.faces),
            open_edges=repaired.open_edges,
            back_face_share=repaired.back_face_share,
            repairs=repaired.repairs,
            residual_defects=file.warnings + repaired.residual_defects,
        )
        yield finding, Solid(name, repaired.mesh)
