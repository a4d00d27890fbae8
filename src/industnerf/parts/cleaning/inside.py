"""Which shell holds which: by the solid angle that it fills, so that a few cracks do no harm."""

import numpy as np
from jaxtyping import Float, Int

from industnerf.artifacts.part import Mesh
from industnerf.parts.cleaning.shells import Shells

WITNESSES = 5  # vertices asked, evenly along the shell: one of them may lie on the other shell


class Nest:
    """The shells of `mesh` apart, and which lies inside which."""

    def __init__(self, mesh: Mesh, shells: Shells) -> None:
        order = np.argsort(shells.of_face, kind="stable")
        self._vertices = mesh.vertices
        self._corners = np.where(shells.odd[:, None], mesh.faces[:, ::-1], mesh.faces)
        self.faces = np.split(order, np.cumsum(np.bincount(shells.of_face))[:-1])
        boxes = [(p.min(axis=(0, 1)), p.max(axis=(0, 1))) for p in map(self._triangles, self.faces)]
        self.low, self.high = np.array(boxes).swapaxes(0, 1)

    def _triangles(self, faces: Int[np.ndarray, "f"]) -> Float[np.ndarray, "f 3 3"]:
        return self._vertices[self._corners[faces]]

    def holders(self, inner: int, among: Int[np.ndarray, "k"]) -> list[int]:
        """Those shells of `among` that hold the shell `inner`."""
        around = (self.low[among] < self.low[inner]) & (self.high[among] > self.high[inner])
        return [o for o in among[around.all(axis=1)].tolist() if self._holds(o, inner)]

    def _holds(self, outer: int, inner: int) -> bool:
        used = np.unique(self._corners[self.faces[inner]])
        witnesses = self._vertices[used[np.linspace(0, len(used) - 1, WITNESSES).astype(int)]]
        triangles = self._triangles(self.faces[outer])
        return bool(np.median([abs(winding_number(triangles, p)) for p in witnesses]) > 0.5)


def winding_number(triangles: Float[np.ndarray, "m 3 3"], point: Float[np.ndarray, "3"]) -> float:
    """How often a closed surface winds about `point`: 1 inside, 0 outside, -1 if inside out.

    The sum of the solid angles of its triangles over 4 pi; van Oosterom and Strackee (1983).
    """
    a, b, c = (triangles - point).swapaxes(0, 1)
    la, lb, lc = (np.linalg.norm(side, axis=1) for side in (a, b, c))
    ab, bc, ca = (np.einsum("ij,ij->i", p, q) for p, q in ((a, b), (b, c), (c, a)))
    numerator = np.einsum("ij,ij->i", a, np.cross(b, c))
    halves = np.arctan2(numerator, la * lb * lc + ab * lc + bc * la + ca * lb)
    return float(halves.sum() / (2 * np.pi))
