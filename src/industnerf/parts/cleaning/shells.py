"""The shells of a mesh: faces that hang together over edges of exactly two faces.

Within a shell every face can be reached from every other without choosing a way, so that its
windings either agree, or can be made to, or the shell has one side only (a Moebius strip).
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from industnerf.artifacts.part import Mesh
from industnerf.parts.checks import doubled_normals
from industnerf.parts.cleaning.edges import components, edges_of


@dataclass(frozen=True)
class Shells:
    of_face: Int[np.ndarray, "m"]  # the shell of each face
    patch: Int[np.ndarray, "m"]  # the patch of each face: the part of its shell wound alike
    odd: Bool[np.ndarray, "m"]  # the smaller part of a shell, wound against the rest
    two_sided: Bool[np.ndarray, "s"]  # turning the odd faces makes all windings agree
    closed: Bool[np.ndarray, "s"]  # two-sided, and every edge joins two faces of the shell
    area: Float[np.ndarray, "s"]
    volume: Float[np.ndarray, "s"]  # with the odd faces turned; meaningful where closed

    def __len__(self) -> int:
        return len(self.closed)

    def sums(self, values: np.ndarray) -> Float[np.ndarray, "s"]:
        """The sum over each shell of what each face has."""
        return np.bincount(self.of_face, values, len(self))


def shells_of(mesh: Mesh) -> Shells:
    m = len(mesh.faces)
    shell = components(edges_of(mesh.faces).neighbours()[0], m)
    # Two shells that share a vertex or an edge are taken apart, and each looked at by itself.
    edges = edges_of(_apart(mesh.faces, shell))
    pairs, alike = edges.neighbours()
    area = np.linalg.norm(doubled_normals(mesh.vertices, mesh.faces), axis=1) / 2
    odd, two_sided = _wound(pairs, alike, shell, area)
    bordered = np.zeros(len(two_sided), bool)
    bordered[shell[(edges.count != 2)[edges.of_face].any(axis=1)]] = True
    signed = np.where(odd, -1, 1) * _cones(mesh, shell)
    return Shells(
        shell,
        components(pairs[alike], m),
        odd,
        two_sided,
        two_sided & ~bordered,
        np.bincount(shell, area, len(two_sided)),
        np.bincount(shell, signed, len(two_sided)),
    )


def _apart(faces: Int[np.ndarray, "m 3"], shell: Int[np.ndarray, "m"]) -> Int[np.ndarray, "m 3"]:
    """`faces` renumbered so that no two shells share a vertex."""
    keys = shell[:, None].astype(np.int64) * (int(faces.max()) + 1) + faces
    return np.unique(keys, return_inverse=True)[1].reshape(-1, 3)


def _wound(
    pairs: Int[np.ndarray, "p 2"],
    alike: Bool[np.ndarray, "p"],
    shell: Int[np.ndarray, "m"],
    area: Float[np.ndarray, "m"],
) -> tuple[Bool[np.ndarray, "m"], Bool[np.ndarray, "s"]]:
    """`Shells.odd` and `Shells.two_sided`.

    Every face f stands twice in a graph, as it is (f) and turned (f + m); neighbours are linked
    such that their windings agree.  The copies of a two-sided shell fall apart into two halves.
    """
    m = len(shell)
    (f, g), other = pairs.T, np.where(alike, 0, m)
    links = np.concatenate([np.stack([f, g + other], 1), np.stack([f + m, g + m - other], 1)])
    half = components(links, 2 * m)
    as_it_is, turned = half[:m], half[m:]
    shells, first = np.unique(shell, return_index=True)
    two_sided = (as_it_is != turned)[first]
    odd = as_it_is != as_it_is[first][shell]
    most = np.bincount(shell, np.where(odd, area, -area), len(shells)) > 0
    return (odd ^ most[shell]) & two_sided[shell], two_sided


def _cones(mesh: Mesh, shell: Int[np.ndarray, "m"]) -> Float[np.ndarray, "m"]:
    """Signed volume of the tetrahedron from each face to one vertex of its shell."""
    first = np.unique(shell, return_index=True)[1]
    apex = mesh.vertices[mesh.faces[first, 0]][shell]
    a, b, c = (mesh.vertices[mesh.faces[:, k]] - apex for k in range(3))
    return np.einsum("ij,ij->i", a, np.cross(b, c)) / 6
