"""The paper's "denoising" of CAD (section 4.1) as a chain of short steps.

Each step takes the solids of a file, repairs one defect, and says in one sentence what it repaired
and what it left.  Between `normalize` and `denormalize` lengths are shares of the bounding-box
diagonal, outside they are mm.  Slivers stay: dropping them opens closed solids.  No hole is filled
and nothing smoothed unless asked: both move the surfaces of CAD.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from industnerf.artifacts.part import Mesh
from industnerf.errors import BadPart
from industnerf.parts.repair.defects import (
    find_residual_defects,
    measure_back_face_share,
    require_surface,
)
from industnerf.parts.repair.edges import build_edges
from industnerf.parts.repair.holes import fill_holes
from industnerf.parts.repair.invalid_faces import deduplicate_faces, drop_nonfinite
from industnerf.parts.repair.loose_faces import drop_loose_faces
from industnerf.parts.repair.mesh_ops import concatenate, fit_normalization
from industnerf.parts.repair.orient import fix_winding
from industnerf.parts.repair.small_components import drop_small_components
from industnerf.parts.repair.smooth import smooth
from industnerf.parts.repair.union import boolean_union
from industnerf.parts.repair.weld import weld
from industnerf.schema import RepairParams

STEPS = (
    deduplicate_faces,
    drop_small_components,
    fix_winding,
    fill_holes,
    smooth,
    boolean_union,
)


@dataclass(frozen=True)
class RepairResult:
    """A mesh in mm, and its defects."""

    mesh: Mesh
    repairs: tuple[str, ...]  # a sentence for each step that had something to do
    residual_defects: tuple[str, ...]  # what is still wrong, or was left on purpose
    open_edges: int  # edges that border one face
    back_face_share: float  # of the rays from outside that hit


def repair_mesh(solids: Sequence[Mesh], settings: RepairParams) -> RepairResult:
    """One mesh of all `solids` (mm), repaired as `settings` asks.

    Raises BadPart if no surface is left.
    """
    bodies, repairs = drop_nonfinite(list(solids))
    # Before the normalization: loose faces may be most of the bounding box.
    bodies, loose_repairs, defects = drop_loose_faces(bodies, settings)
    normalization = fit_normalization(bodies)
    bodies = [normalization.normalize(body) for body in bodies]
    try:
        require_surface(bodies)
        bodies, weld_repairs, _ = weld(bodies, settings)
    except BadPart as error:  # what was left may be why
        raise BadPart("; ".join([str(error), *defects])) from error
    repairs += loose_repairs + weld_repairs
    for step in STEPS:
        require_surface(bodies)
        bodies, step_repairs, step_defects = step(bodies, settings)
        repairs += step_repairs
        defects += step_defects
    mesh = concatenate(bodies)
    edges, back_face_share = build_edges(mesh.faces), measure_back_face_share(mesh)
    defects += find_residual_defects(mesh, edges, back_face_share)
    open_edges = int((edges.face_count == 1).sum())
    return RepairResult(
        normalization.denormalize(mesh), tuple(repairs), tuple(defects), open_edges, back_face_share
    )
