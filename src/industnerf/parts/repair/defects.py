"""What makes a mesh unusable, and what is still wrong with it after the repair."""

import numpy as np

from industnerf.artifacts.part import Mesh
from industnerf.errors import BadPart
from industnerf.geometry.raycast import RaycastingScene
from industnerf.parts.repair.edges import Edges
from industnerf.parts.validation import checks
from industnerf.parts.validation.checks import area_mm2

MIN_THICKNESS = 1e-6  # diagonals: the thickness below which a part is a sheet
MIN_FACES = 2  # a single triangle is no part; two make a sheet, and four a solid
MIN_AREA = 1e-6  # area in squared diagonals: a ribbon so narrow is a line to any camera


def measure_back_face_share(mesh: Mesh) -> float:
    """Of the rays from outside that hit, the share that meets a face from behind."""
    scene = RaycastingScene(mesh.vertices, mesh.faces)
    return checks.back_face_share(mesh.vertices, mesh.faces, lambda o, d: scene.cast(o, d).face)


def find_residual_defects(mesh: Mesh, edges: Edges, back_face_share: float) -> list[str]:
    """A sentence for each fault of `mesh`, which is in the unit frame."""
    kinds = {
        "open edges": edges.face_count == 1,
        "edges of more than two faces": edges.face_count > 2,
        "edges of two faces wound against each other": (edges.face_count == 2) & ~edges.is_sound,
    }
    messages = [f"{kind}: {mask.sum()}" for kind, mask in kinds.items() if mask.any()]
    if back_face_share > checks.MAX_BACK_FACE_SHARE:
        messages.append(f"rays from outside that meet a face from behind: {back_face_share:.2%}")
    if _thickness(mesh) < MIN_THICKNESS:
        messages.append("flat: a sheet without thickness or volume")
    return messages


def _thickness(mesh: Mesh) -> float:
    """Extent along the direction in which the vertices spread least."""
    centered = mesh.vertices - mesh.vertices.mean(axis=0)
    direction = np.linalg.eigh(centered.T @ centered)[1][:, 0]
    return float(np.ptp(centered @ direction))


def require_surface(solids: list[Mesh]) -> None:
    """Raise BadPart unless `solids`, in the unit frame, hold a surface that can be seen."""
    faces = sum(len(solid.faces) for solid in solids)
    if faces < MIN_FACES:
        raise BadPart(f"it has {faces} sound face, and no part has fewer than {MIN_FACES}")
    area = sum(area_mm2(solid.vertices, solid.faces) for solid in solids)
    if area < MIN_AREA:
        raise BadPart(
            f"its {faces} faces lie on a line: their area is {area:.1e} of the squared diagonal"
        )
    if not np.isfinite(area):
        raise BadPart("its area is not finite")
