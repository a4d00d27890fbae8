"""The paper's "denoising" (4.1) of a user's CAD, made concrete: a chain of short steps.

Each step takes the solids of a file, repairs one defect, and says in one sentence what it repaired
and what it left.  Between `normalize` and `denormalize` lengths are shares of the bounding-box
diagonal, outside they are mm.  Slivers stay: dropping them opens closed solids.  No hole is filled
and nothing smoothed unless asked: both move the surfaces of CAD.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from industnerf.artifacts.part import Mesh
from industnerf.parts.repair.defects import (
    find_residual_defects,
    measure_back_face_share,
    require_surface,
)
from industnerf.parts.repair.edges import build_edges
from industnerf.parts.repair.holes import fill_holes
from industnerf.parts.repair.invalid_faces import deduplicate_faces, drop_nonfinite
from industnerf.parts.repair.mesh_ops import concatenate, fit_normalization
from industnerf.parts.repair.orient import fix_winding
from industnerf.parts.repair.small_components import drop_small_components
from industnerf.parts.repair.smooth import smooth
from industnerf.parts.repair.union import boolean_union
from industnerf.parts.repair.weld import weld
from industnerf.schema import RepairParams

STEPS = (
    weld,
    deduplicate_faces,
    drop_small_components,
    fix_winding,
    fill_holes,
    smooth,
    boolean_union,
)


@dataclass(frozen=True)
class RepairResult:
    """A mesh in mm, and what was the matter with it."""

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
    defects: list[str] = []
    normalization = fit_normalization(bodies)
    bodies = [normalization.normalize(body) for body in bodies]
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
