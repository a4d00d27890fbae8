"""What drawing a part gives, whether a CAD kernel drew it or a formula."""

from dataclasses import dataclass
from typing import Literal

from industnerf.artifacts.part import Appearance, Mesh

REFERENCE_REFINEMENT = (
    4  # times finer: the mesh whose volume is taken for exact where no B-rep's is
)


@dataclass(frozen=True)
class MeshPart:
    """A mesh, its finishes, and the volume that it is held against."""

    mesh: Mesh
    finishes: tuple[Appearance, ...]  # that the mesh counts
    reference: Literal["b-rep", "finer mesh"]
    reference_volume_mm3: float
