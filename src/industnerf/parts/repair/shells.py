"""The shells of a mesh, and which lies inside which.

A shell is a set of faces connected over edges of exactly two faces.  So its windings either agree,
or can be made to, or the shell has one side only (a Moebius strip).  Containment is decided by the
winding number, which a few cracks do not change.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from industnerf.artifacts.part import Mesh
from industnerf.parts.repair.edges import build_edges, component_labels
from industnerf.parts.validation.checks import double_area_normals

NUM_SAMPLE_VERTICES = (
    5  # vertices asked, evenly along the shell: one of them may lie on the other shell
)


@dataclass(frozen=True)
class Shells:
    shell_of_face: Int[np.ndarray, "m"]  # the shell of each face
    patch_of_face: Int[np.ndarray, "m"]  # the patch of each face: the part of its shell wound alike
    is_minority: Bool[np.ndarray, "m"]  # the smaller part of a shell, wound against the rest
    is_two_sided: Bool[np.ndarray, "s"]  # turning the minority makes all windings agree
    is_closed: Bool[np.ndarray, "s"]  # two-sided, and every edge joins two faces of the shell
    area: Float[np.ndarray, "s"]
    volume: Float[np.ndarray, "s"]  # with the minority turned; meaningful where closed

    def __len__(self) -> int:
        return len(self.is_closed)

    def sum_per_shell(self, values: np.ndarray) -> Float[np.ndarray, "s"]:
        """The sum over each shell of what each face has."""
        return np.bincount(self.shell_of_face, values, len(self))


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
        """Those shells of `candidates` that hold the shell `inner`."""
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


def find_shells(mesh: Mesh) -> Shells:
    m = len(mesh.faces)
    shell = component_labels(build_edges(mesh.faces).adjacent_faces()[0], m)
    # Two shells that share a vertex or an edge are taken apart, and each looked at by itself.
    edges = build_edges(_separate_shells(mesh.faces, shell))
    pairs, is_consistent = edges.adjacent_faces()
    area = np.linalg.norm(double_area_normals(mesh.vertices, mesh.faces), axis=1) / 2
    is_minority, is_two_sided = _find_minority(pairs, is_consistent, shell, area)
    has_border = np.zeros(len(is_two_sided), bool)
    has_border[shell[(edges.face_count != 2)[edges.edges_of_face].any(axis=1)]] = True
    signed = np.where(is_minority, -1, 1) * _tetrahedron_volumes(mesh, shell)
    return Shells(
        shell,
        component_labels(pairs[is_consistent], m),
        is_minority,
        is_two_sided,
        is_two_sided & ~has_border,
        np.bincount(shell, area, len(is_two_sided)),
        np.bincount(shell, signed, len(is_two_sided)),
    )


def _separate_shells(
    faces: Int[np.ndarray, "m 3"], shell: Int[np.ndarray, "m"]
) -> Int[np.ndarray, "m 3"]:
    """`faces` renumbered so that no two shells share a vertex."""
    keys = shell[:, None].astype(np.int64) * (int(faces.max()) + 1) + faces
    return np.unique(keys, return_inverse=True)[1].reshape(-1, 3)


def _find_minority(
    pairs: Int[np.ndarray, "p 2"],
    is_consistent: Bool[np.ndarray, "p"],
    shell: Int[np.ndarray, "m"],
    area: Float[np.ndarray, "m"],
) -> tuple[Bool[np.ndarray, "m"], Bool[np.ndarray, "s"]]:
    """`Shells.is_minority` and `Shells.is_two_sided`.

    Every face f stands twice in a graph, as it is (f) and turned (f + m); neighbors are linked
    such that their windings agree.  The copies of a two-sided shell fall apart into two halves.
    """
    m = len(shell)
    (f, g), offset = pairs.T, np.where(is_consistent, 0, m)
    links = np.concatenate([np.stack([f, g + offset], 1), np.stack([f + m, g + m - offset], 1)])
    labels = component_labels(links, 2 * m)
    unflipped, flipped = labels[:m], labels[m:]
    shells, first = np.unique(shell, return_index=True)
    is_two_sided = (unflipped != flipped)[first]
    is_minority = unflipped != unflipped[first][shell]
    is_majority = np.bincount(shell, np.where(is_minority, area, -area), len(shells)) > 0
    return (is_minority ^ is_majority[shell]) & is_two_sided[shell], is_two_sided


def _tetrahedron_volumes(mesh: Mesh, shell: Int[np.ndarray, "m"]) -> Float[np.ndarray, "m"]:
    """Signed volume of the tetrahedron from each face to one vertex of its shell."""
    first = np.unique(shell, return_index=True)[1]
    apex = mesh.vertices[mesh.faces[first, 0]][shell]
    a, b, c = (mesh.vertices[mesh.faces[:, k]] - apex for k in range(3))
    return np.einsum("ij,ij->i", a, np.cross(b, c)) / 6


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
