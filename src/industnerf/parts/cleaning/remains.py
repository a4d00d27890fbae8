"""What is still wrong with a mesh when cleaning is done."""

import numpy as np

from industnerf.artifacts.part import Mesh
from industnerf.geometry.raycast import Scene
from industnerf.parts import checks
from industnerf.parts.cleaning.edges import Edges

FLAT = 1e-6  # diagonals: the thickness below which a part is a sheet


def seen_from_behind(mesh: Mesh) -> float:
    """Of the rays from outside that hit, the share that meets a face from behind."""
    scene = Scene(mesh.vertices, mesh.faces)
    return checks.back_face_share(mesh.vertices, mesh.faces, lambda o, d: scene.cast(o, d).face)


def remaining(mesh: Mesh, edges: Edges, behind: float) -> list[str]:
    """A sentence for each fault of `mesh`, which is in the unit frame."""
    kinds = {
        "open edges": edges.count == 1,
        "edges of more than two faces": edges.count > 2,
        "edges of two faces wound against each other": (edges.count == 2) & ~edges.sound,
    }
    told = [f"{kind}: {which.sum()}" for kind, which in kinds.items() if which.any()]
    if behind > checks.MOST_BACK_FACES:
        told.append(f"rays from outside that meet a face from behind: {behind:.2%}")
    if _thickness(mesh) < FLAT:
        told.append("flat: a sheet without thickness or volume")
    return told


def _thickness(mesh: Mesh) -> float:
    """Extent along the direction in which the vertices spread least."""
    centred = mesh.vertices - mesh.vertices.mean(axis=0)
    least = np.linalg.eigh(centred.T @ centred)[1][:, 0]
    return float(np.ptp(centred @ least))
