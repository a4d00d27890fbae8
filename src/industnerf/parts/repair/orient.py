"""Winding: faces turned outward by the vote of rays from outside.

Each patch of faces that are wound alike is turned if most rays meet it from behind.  A shell whose
windings can be made to agree is turned as a whole unless the rays contradict it.  A closed shell
that hardly a ray reaches is judged by its volume and by the shell that contains it, in
`_orient_hidden_shells`: such rays came in through a crack.  No other shell can come out worse than
it was, and no open one is touched where that improves nothing.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Int

from industnerf.artifacts.part import Mesh
from industnerf.geometry.raycast import RaycastingScene, parallel_ray_bundles
from industnerf.parts.repair.mesh_ops import concatenate, replace_faces, solid_of_faces
from industnerf.parts.repair.shells import ContainmentTree, Shells, find_shells
from industnerf.parts.validation.checks import double_area_normals
from industnerf.schema import RepairParams

MAJORITY_SHARE = 0.55  # of a patch's rays; a sheet is seen from both sides alike and stays
MAX_STRAY_SHARE = 0.01  # of a shell's rays: so many may speak against making its windings agree
HIDDEN_SHARE = 0.05  # of the rays that would reach a closed shell if it stood alone: it is hidden
MIN_GAIN = 1e-4  # of all rays that hit: so many turned open shells must spare from the back
NUM_BEAMS, RAYS_PER_SIDE = 100, 96


@dataclass(frozen=True)
class OrientationVotes:
    """Rays that met each face from its front, and from behind."""

    front: Int[np.ndarray, "m"]
    back: Int[np.ndarray, "m"]
    density: float  # rays that would meet a unit of area of a convex solid that stood alone

    def back_votes(self, flipped: Bool[np.ndarray, "m"]) -> Int[np.ndarray, "m"]:
        """The rays that would meet each face from behind, were those `flipped` turned."""
        return np.where(flipped, self.front, self.back)

    def back_share(self, flipped: Bool[np.ndarray, "m"]) -> float:
        """Of all rays that hit, the share that meets a face from behind, likewise."""
        return float(self.back_votes(flipped).sum() / max((self.front + self.back).sum(), 1))


def fix_winding(
    solids: list[Mesh], settings: RepairParams
) -> tuple[list[Mesh], list[str], list[str]]:
    """`solids` with faces turned where that shows fewer of them from behind."""
    if not settings.fix_winding:
        return solids, [], []
    whole = concatenate(solids)
    shells, votes = find_shells(whole), ray_votes(whole)
    first = np.unique(shells.shell_of_face, return_index=True)[1]
    flipped = _faces_to_flip(whole, shells, votes, solid_of_faces(solids)[first])
    flipped &= _is_improved(shells, votes, flipped)[shells.shell_of_face]
    if not flipped.any():
        return solids, [], []
    before, after = (f"{votes.back_share(mask):.2%}" for mask in (np.zeros_like(flipped), flipped))
    effect = f"; of the rays from outside, {before} met a face from behind, now {after}"
    if before == after:
        effect = ", which hardly a ray from outside meets"
    message = f"faces turned: {flipped.sum()} of {len(flipped)}{effect}"
    faces = np.where(flipped[:, None], whole.faces[:, ::-1], whole.faces)
    return replace_faces(solids, faces), [message], []


def _faces_to_flip(
    mesh: Mesh, shells: Shells, votes: OrientationVotes, solid: Int[np.ndarray, "s"]
) -> Bool[np.ndarray, "m"]:
    """Which faces to turn; `solid` is that of each shell."""
    patch_flips = _patches_to_flip(shells, votes)
    agreeing, reversed_ = shells.is_minority, ~shells.is_minority
    back_votes = [shells.sum_per_shell(votes.back_votes(mask)) for mask in (agreeing, reversed_)]
    num_votes = back_votes[0] + back_votes[1]
    flipped = back_votes[0] > MAJORITY_SHARE * num_votes
    hidden = shells.is_closed & (num_votes < HIDDEN_SHARE * votes.density * shells.area)
    _orient_hidden_shells(mesh, shells, hidden, flipped, solid)
    shell_flips = agreeing ^ flipped[shells.shell_of_face]
    best_by_patch = (
        shells.sum_per_shell(votes.back_votes(patch_flips)) + MAX_STRAY_SHARE * num_votes
    )
    current = shells.sum_per_shell(votes.back_votes(np.zeros_like(patch_flips)))
    prefers_shell = shells.is_two_sided & (
        np.where(flipped, back_votes[1], back_votes[0]) <= np.minimum(best_by_patch, current)
    )
    return np.where(
        (prefers_shell & (num_votes > 0) | hidden)[shells.shell_of_face], shell_flips, patch_flips
    )


def _is_improved(
    shells: Shells, votes: OrientationVotes, flipped: Bool[np.ndarray, "m"]
) -> Bool[np.ndarray, "s"]:
    """Whether to turn the `flipped` faces of each shell.

    A closed shell has one right winding, and faces that no ray meets are best wound as their
    neighbors.  Other faces of open shells are turned if fewer rays then meet them from behind, by
    at least MIN_GAIN for all such shells together: a soup is as many shells as triangles.
    """
    num_votes = votes.front + votes.back
    is_visible = shells.sum_per_shell(np.where(flipped, num_votes, 0)) > 0
    gain = shells.sum_per_shell(votes.back - votes.back_votes(flipped))
    is_gaining = ~shells.is_closed & (gain > 0)
    is_gaining &= gain[is_gaining].sum() >= MIN_GAIN * num_votes.sum()
    return shells.is_closed | ~is_visible | is_gaining


def _patches_to_flip(shells: Shells, votes: OrientationVotes) -> Bool[np.ndarray, "m"]:
    back, front = (np.bincount(shells.patch_of_face, v) for v in (votes.back, votes.front))
    return (back > MAJORITY_SHARE * (back + front))[shells.patch_of_face]


def _orient_hidden_shells(
    mesh: Mesh,
    shells: Shells,
    hidden: Bool[np.ndarray, "s"],
    flipped: Bool[np.ndarray, "s"],
    solid: Int[np.ndarray, "s"],
) -> None:
    """Decide `flipped`, in place, of the closed shells that are `hidden`.

    A hidden shell within another shell of its solid is a cavity, so it is rightly inside out.  But
    where both are consistently wound in the file, they turn together.
    """
    if not hidden.any():
        return
    containment, outer = ContainmentTree(mesh, shells), np.flatnonzero(~hidden)
    is_consistent = shells.sum_per_shell(shells.is_minority) == 0
    for shell in np.flatnonzero(hidden).tolist():
        containing = containment.containing_shells(shell, outer[solid[outer] == solid[shell]])
        largest_container = max(
            containing, key=lambda container: abs(shells.volume[container]), default=None
        )
        if largest_container is None:
            flipped[shell] = shells.volume[shell] < 0
        elif is_consistent[shell] and is_consistent[largest_container]:
            flipped[shell] = flipped[largest_container]
        else:
            flipped[shell] = shells.volume[shell] > 0


def ray_votes(mesh: Mesh) -> OrientationVotes:
    """The votes of `NUM_BEAMS` beams of `RAYS_PER_SIDE`**2 rays each."""
    scene = RaycastingScene(mesh.vertices, mesh.faces)
    width = float(np.linalg.norm(np.ptp(mesh.vertices, axis=0)))
    # Cauchy: the mean shadow of a convex solid is a quarter of its surface.
    density = NUM_BEAMS * (RAYS_PER_SIDE / width) ** 2 / 4
    normals, n = double_area_normals(mesh.vertices, mesh.faces), len(mesh.faces)
    front, back = np.zeros(n, np.int64), np.zeros(n, np.int64)
    for origins, direction in parallel_ray_bundles(mesh.vertices, NUM_BEAMS, RAYS_PER_SIDE):
        face = scene.cast(origins, np.broadcast_to(direction, origins.shape)).face
        hits = np.bincount(face[face >= 0], minlength=n)
        is_back = normals @ direction > 0
        front += np.where(is_back, 0, hits)
        back += np.where(is_back, hits, 0)
    return OrientationVotes(front, back, density)
