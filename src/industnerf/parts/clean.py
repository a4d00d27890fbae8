"""The paper's "denoising" (4.1), made concrete: each step mends one defect and says so.

Nothing is smoothed and no hole is filled: both move CAD surfaces.  Slivers stay: dropping them
opens closed solids.
"""

import numpy as np
from jaxtyping import Float, Int
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from industnerf.artifacts.part import Mesh
from industnerf.errors import BadPart
from industnerf.parts.checks import bad_edges, volume_mm3

FEWEST_FACES = 4  # of any solid


def clean(
    vertices: Float[np.ndarray, "n 3"], faces: Int[np.ndarray, "m 3"], weld: float
) -> tuple[Mesh, tuple[str, ...]]:
    """A welded, oriented mesh, and what was wrong with it, mended or left.

    `weld` is a share of the diagonal.  Raises BadPart if no solid is left.
    """
    defects: list[str] = []
    faces = _finite(vertices, faces, defects)
    diagonal = _diagonal(vertices[faces.ravel()])
    vertices, faces = _welded(vertices, faces, weld * diagonal)
    faces = _distinct(faces, defects)
    if len(faces) < FEWEST_FACES:
        raise BadPart(f"{len(faces)} distinct faces: a solid has at least {FEWEST_FACES}")
    faces = _outward(vertices, faces, defects)
    return Mesh(vertices, faces.astype(np.int32)), tuple(defects)


def _finite(vertices: np.ndarray, faces: np.ndarray, defects: list[str]) -> np.ndarray:
    good = np.isfinite(vertices).all(axis=1)[faces].all(axis=1)
    if not good.all():
        defects.append(f"dropped {(~good).sum()} faces with a non-finite vertex")
    if not good.any():
        raise BadPart("no face has finite vertices")
    return faces[good]


def _diagonal(points: np.ndarray) -> float:
    diagonal = float(np.linalg.norm(np.ptp(points, axis=0)))
    if not 0 < diagonal < np.inf:
        raise BadPart(f"its bounding box has a diagonal of {diagonal} mm")
    return diagonal


def _welded(
    vertices: np.ndarray, faces: np.ndarray, tolerance_mm: float
) -> tuple[np.ndarray, np.ndarray]:
    """Vertices that faces use, those nearer than `tolerance_mm` made one."""
    used, faces = np.unique(faces, return_inverse=True)
    points, same = np.unique(vertices[used], axis=0, return_inverse=True)
    centred = points - points.mean(axis=0)  # so that a far-off part loses no digits
    near = cKDTree(centred).query_pairs(tolerance_mm, output_type="ndarray")
    links = coo_array((np.ones(len(near)), (near[:, 0], near[:, 1])), (len(points), len(points)))
    _, group = connected_components(links, directed=False)
    _, first = np.unique(group, return_index=True)
    return points[first], group[same.ravel()][faces].reshape(-1, 3)


def _distinct(faces: np.ndarray, defects: list[str]) -> np.ndarray:
    """Faces of three different corners, each once, whichever way round."""
    ordered = np.sort(faces, axis=1)
    solid = (ordered[:, 0] != ordered[:, 1]) & (ordered[:, 1] != ordered[:, 2])
    _, first = np.unique(ordered[solid], axis=0, return_index=True)
    repeated = int(solid.sum()) - len(first)
    if repeated:
        defects.append(f"dropped {repeated} faces that repeat another")
    return faces[solid][np.sort(first)]


def _outward(vertices: np.ndarray, faces: np.ndarray, defects: list[str]) -> np.ndarray:
    open_edges = len(bad_edges(faces))
    if open_edges:
        defects.append(f"left {open_edges} edges that do not join two faces of one orientation")
    elif volume_mm3(vertices, faces) < 0:
        defects.append("turned inside out")
        return faces[:, ::-1]
    return faces
