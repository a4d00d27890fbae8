"""Faces turned outward, by what rays from outside see.

Each patch of faces that are wound alike is turned if most rays meet it from behind.  A shell whose
windings can be made to agree is turned as a whole where the rays do not speak against it.  A
closed shell that hardly a ray reaches is judged by its volume and by the shell that holds it: see
`_settle_hidden`.  Such rays came in through a crack; on all others no shell can come out worse
than it was.
"""

import numpy as np
from jaxtyping import Bool, Int

from industnerf.artifacts.part import Mesh
from industnerf.parts.cleaning.inside import Nest
from industnerf.parts.cleaning.selection import joined, refaced, solid_of_faces
from industnerf.parts.cleaning.shells import Shells, shells_of
from industnerf.parts.cleaning.votes import Votes, cast_votes
from industnerf.schema import CleanParams

MAJORITY = 0.55  # of a patch's rays; a sheet is seen from both sides alike, and stays as it is
STRAY = 0.01  # of a shell's rays: so many may speak against making its windings agree
HARDLY = 0.05  # of the rays that would reach a closed shell if it stood alone: it is hidden


def orient(solids: list[Mesh], settings: CleanParams) -> tuple[list[Mesh], list[str], list[str]]:
    """`solids` with faces turned where that shows fewer of them from behind."""
    if not settings.orient:
        return solids, [], []
    whole = joined(solids)
    shells, votes = shells_of(whole), cast_votes(whole)
    first = np.unique(shells.of_face, return_index=True)[1]
    turned = _turned(whole, shells, votes, solid_of_faces(solids)[first])
    if not turned.any():
        return solids, [], []
    before, after = votes.share_behind(np.zeros_like(turned)), votes.share_behind(turned)
    said = (
        f"faces turned: {turned.sum()} of {len(turned)}; of the rays from outside, {before:.2%} "
        f"met a face from behind, now {after:.2%}"
    )
    faces = np.where(turned[:, None], whole.faces[:, ::-1], whole.faces)
    return refaced(solids, faces), [said], []


def _turned(
    mesh: Mesh, shells: Shells, votes: Votes, solid: Int[np.ndarray, "s"]
) -> Bool[np.ndarray, "m"]:
    """Which faces to turn; `solid` is that of each shell."""
    by_patch = _by_patch(shells, votes)
    agreeing, reversed_ = shells.odd, ~shells.odd
    ways = [shells.sums(votes.against(way)) for way in (agreeing, reversed_)]
    seen = ways[0] + ways[1]
    flipped = ways[0] > MAJORITY * seen
    hidden = shells.closed & (seen < HARDLY * votes.density * shells.area)
    _settle_hidden(mesh, shells, hidden, flipped, solid)
    as_one = agreeing ^ flipped[shells.of_face]
    least = shells.sums(votes.against(by_patch)) + STRAY * seen
    now = shells.sums(votes.against(np.zeros_like(by_patch)))
    chosen = shells.two_sided & (np.where(flipped, ways[1], ways[0]) <= np.minimum(least, now))
    return np.where((chosen & (seen > 0) | hidden)[shells.of_face], as_one, by_patch)


def _by_patch(shells: Shells, votes: Votes) -> Bool[np.ndarray, "m"]:
    behind, front = (np.bincount(shells.patch, v) for v in (votes.behind, votes.front))
    return (behind > MAJORITY * (behind + front))[shells.patch]


def _settle_hidden(
    mesh: Mesh,
    shells: Shells,
    hidden: Bool[np.ndarray, "s"],
    flipped: Bool[np.ndarray, "s"],
    solid: Int[np.ndarray, "s"],
) -> None:
    """Decide `flipped`, in place, of the closed shells that are `hidden`.

    One that a shell of its own solid holds is a cavity, hence rightly inside out, unless file and
    rays say otherwise: where both are wound alike in themselves, they turn together.
    """
    if not hidden.any():
        return
    nest, outer = Nest(mesh, shells), np.flatnonzero(~hidden)
    alike = shells.sums(shells.odd) == 0
    for shell in np.flatnonzero(hidden).tolist():
        holders = nest.holders(shell, outer[solid[outer] == solid[shell]])
        largest = max(holders, key=lambda holder: abs(shells.volume[holder]), default=None)
        if largest is None:
            flipped[shell] = shells.volume[shell] < 0
        elif alike[shell] and alike[largest]:
            flipped[shell] = flipped[largest]
        else:
            flipped[shell] = shells.volume[shell] > 0
