"""Closed bodies that share room: a thread that reaches into its shank, a pin into its plate."""

from dataclasses import dataclass

import manifold3d
import numpy as np
from jaxtyping import Float, Int

from industnerf.parts.cleaning.bodies import Body

LEAST = 1e-3  # of the smaller body's volume; the facets of a pin and of its bore interlock by less
MOST_PAIRS = 500  # that are looked at, in order; a pair takes some 5 ms


@dataclass(frozen=True)
class Overlaps:
    pairs: Int[np.ndarray, "p 2"]  # of bodies that overlap
    share: float  # the largest overlap, of the smaller body's volume
    unlooked: int  # pairs with boxes that overlap, beyond MOST_PAIRS


def overlaps_of(bodies: list[Body]) -> Overlaps:
    near = _near(bodies)
    shares = np.array([_shared(bodies[a], bodies[b]) for a, b in near[:MOST_PAIRS]])
    return Overlaps(
        near[:MOST_PAIRS][shares > LEAST].reshape(-1, 2),
        float(shares.max(initial=0.0)),
        max(len(near) - MOST_PAIRS, 0),
    )


def described(overlaps: Overlaps) -> list[str]:
    """What to say if the bodies are left as they are."""
    told = []
    if len(overlaps.pairs):
        told.append(
            f"overlapping pairs of bodies: {len(overlaps.pairs)}, by up to {overlaps.share:.1%} "
            "of the smaller (parts.clean.union unites them)"
        )
    return told + unsearched(overlaps)


def unsearched(overlaps: Overlaps) -> list[str]:
    """What to say of the pairs that were not looked at, whatever became of the others."""
    if not overlaps.unlooked:
        return []
    return [
        f"pairs of bodies not searched for overlap: {overlaps.unlooked}, beyond the first "
        f"{MOST_PAIRS}"
    ]


def _near(bodies: list[Body]) -> Int[np.ndarray, "p 2"]:
    """Pairs of bodies whose boxes overlap."""
    if len(bodies) < 2:
        return np.empty((0, 2), np.int64)
    low, high = np.array([b.low for b in bodies]), np.array([b.high for b in bodies])
    rows = [
        np.column_stack([np.full(len(found), i), found])
        for i in range(len(bodies) - 1)
        for found in [i + 1 + np.flatnonzero(_boxes_meet(low, high, i))]
    ]
    return np.concatenate(rows)


def _boxes_meet(
    low: Float[np.ndarray, "b 3"], high: Float[np.ndarray, "b 3"], i: int
) -> np.ndarray:
    """Whether the box of each body after the `i`th overlaps its box."""
    return ((low[i + 1 :] < high[i]) & (high[i + 1 :] > low[i])).all(axis=1)


def _shared(a: Body, b: Body) -> float:
    common = manifold3d.Manifold.batch_boolean(
        [a.manifold, b.manifold], manifold3d.OpType.Intersect
    )
    # A body that crosses itself counts some of its room twice: no more than all is said.
    return min(common.volume() / min(a.manifold.volume(), b.manifold.volume()), 1.0)
