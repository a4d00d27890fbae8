"""Which shell holds which: by the solid angle that it fills, so that a few cracks do no harm."""

import numpy as np
from jaxtyping import Float, Int

from industnerf.artifacts.part import Mesh
from industnerf.parts.repair.shells import Shells

NUM_SAMPLE_VERTICES = (
    5  # vertices asked, evenly along the shell: one of them may lie on the other shell
)


class ContainmentTree:
    """The shells of `mesh` apart, and which lies inside which."""

    def __init__(self, mesh: Mesh, shells: Shells) -> None:
        order = np.argsort(shells.shell_of_face, kind="stable")
        self._vertices = mesh.vertices
        self._corners = np.where(shells.is_minority[:, None], mesh.faces[:, ::-1], mesh.faces)
        self.faces = np.split(order, np.cumsum(np.bincount(shells.shell_of_face))[:-1])
        boxes = [(p.min(axis=(0, 1)), p.max(axis=(0, 1))) for p in map(self._triangles, self.faces)]
        self.low, self.high = np.array(boxes).swapaxes(0, 1)

    def _triangles(self, faces: Int[np.ndarray, "f"]) -> Float[np.ndarray, "f 3 3"]:
        return self._vertices[self._corners[faces]]

    def containing_shells(self, inner: int, candidates: Int[np.ndarray, "k"]) -> list[int]:
        """Those shells of `among` that hold the shell `inner`."""
        is_enclosing = (self.low[candidates] < self.low[inner]) & (
            self.high[candidates] > self.high[inner]
        )
        return [
            outer
            for outer in candidates[is_enclosing.all(axis=1)].tolist()
            if self._contains(outer, inner)
        ]

    def _contains(self, outer: int, inner: int) -> bool:
        used = np.unique(self._corners[self.faces[inner]])
        sample_points = self._vertices[
            used[np.linspace(0, len(used) - 1, NUM_SAMPLE_VERTICES).astype(int)]
        ]
        triangles = self._triangles(self.faces[outer])
        return bool(np.median([abs(winding_number(triangles, p)) for p in sample_points]) > 0.5)


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
