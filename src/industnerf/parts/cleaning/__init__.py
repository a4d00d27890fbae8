"""The paper's "denoising" (4.1) of a user's CAD, made concrete: a chain of short steps.

Each step takes the solids of a file, mends one defect, and says in one sentence what it mended and
what it left.  Between `Frame.unit` and `Frame.restored` lengths are shares of the bounding-box
diagonal, outside they are mm.  Slivers stay: dropping them opens closed solids.  No hole is filled
and nothing smoothed unless asked: both move the surfaces of CAD.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from industnerf.artifacts.part import Mesh
from industnerf.parts.cleaning.distinct import distinct
from industnerf.parts.cleaning.edges import edges_of
from industnerf.parts.cleaning.finite import finite
from industnerf.parts.cleaning.frame import frame_of
from industnerf.parts.cleaning.holes import fill_holes
from industnerf.parts.cleaning.orient import orient
from industnerf.parts.cleaning.refuse import require_surface
from industnerf.parts.cleaning.remains import remaining, seen_from_behind
from industnerf.parts.cleaning.selection import joined
from industnerf.parts.cleaning.smooth import smooth
from industnerf.parts.cleaning.specks import drop_specks
from industnerf.parts.cleaning.union import unite
from industnerf.parts.cleaning.weld import weld
from industnerf.schema import CleanParams

STEPS = (weld, distinct, drop_specks, orient, fill_holes, smooth, unite)


@dataclass(frozen=True)
class Cleaned:
    """A mesh in mm, and what was the matter with it."""

    mesh: Mesh
    mended: tuple[str, ...]  # a sentence for each step that had something to do
    remaining: tuple[str, ...]  # what is still wrong, or was left on purpose
    open_edges: int  # edges that border one face
    back_face_share: float  # of the rays from outside that hit


def clean(solids: Sequence[Mesh], settings: CleanParams) -> Cleaned:
    """One mesh of all `solids` (mm), mended as `settings` asks.

    Raises BadPart if no surface is left.
    """
    bodies, mended = finite(list(solids))
    left: list[str] = []
    frame = frame_of(bodies)
    bodies = [frame.unit(body) for body in bodies]
    for step in STEPS:
        require_surface(bodies)
        bodies, told, kept = step(bodies, settings)
        mended += told
        left += kept
    mesh = joined(bodies)
    edges, behind = edges_of(mesh.faces), seen_from_behind(mesh)
    left += remaining(mesh, edges, behind)
    open_edges = int((edges.count == 1).sum())
    return Cleaned(frame.restored(mesh), tuple(mended), tuple(left), open_edges, behind)
