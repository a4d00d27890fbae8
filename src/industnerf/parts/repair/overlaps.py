"""Closed bodies that share room: a thread that reaches into its shank, a pin into its plate."""

from dataclasses import dataclass

import manifold3d
import numpy as np
from jaxtyping import Float, Int

from industnerf.parts.repair.bodies import ClosedBody

MIN_OVERLAP = (
    1e-3  # of the smaller body's volume; the facets of a pin and of its bore interlock by less
)
MAX_PAIRS = 500  # that are looked at, in order; a pair takes some 5 ms


@dataclass(frozen=True)
class Overlaps:
    pairs: Int[np.ndarray, "p 2"]  # of bodies that overlap
    max_share: float  # the largest overlap, of the smaller body's volume
    num_unchecked: int  # pairs with boxes that overlap, beyond MOST_PAIRS


def find_overlaps(bodies: list[ClosedBody]) -> Overlaps:
    candidates = _candidate_pairs(bodies)
    shares = np.array([_overlap_share(bodies[a], bodies[b]) for a, b in candidates[:MAX_PAIRS]])
    return Overlaps(
        candidates[:MAX_PAIRS][shares > MIN_OVERLAP].reshape(-1, 2),
        float(shares.max(initial=0.0)),
        max(len(candidates) - MAX_PAIRS, 0),
    )


def overlap_warnings(overlaps: Overlaps) -> list[str]:
    """What to say if the bodies are left as they are."""
    messages = []
    if len(overlaps.pairs):
        messages.append(
            f"overlapping pairs of bodies: {len(overlaps.pairs)}, by up to {overlaps.max_share:.1%} "
            "of the smaller (parts.repair.boolean_union unites them)"
        )
    return messages + unchecked_warnings(overlaps)


def unchecked_warnings(overlaps: Overlaps) -> list[str]:
    """What to say of the pairs that were not looked at, whatever became of the others."""
    if not overlaps.num_unchecked:
        return []
    return [
        f"pairs of bodies not searched for overlap: {overlaps.num_unchecked}, beyond the first "
        f"{MAX_PAIRS}"
    ]


def _candidate_pairs(bodies: list[ClosedBody]) -> Int[np.ndarray, "p 2"]:
    """Pairs of bodies whose boxes overlap."""
    if len(bodies) < 2:
        return np.empty((0, 2), np.int64)
    low, high = np.array([b.low for b in bodies]), np.array([b.high for b in bodies])
    rows = [
        np.column_stack([np.full(len(overlapping), i), overlapping])
        for i in range(len(bodies) - 1)
        for overlapping in [i + 1 + np.flatnonzero(_boxes_overlap(low, high, i))]
    ]
    return np.concatenate(rows)


def _boxes_overlap(
    low: Float[np.ndarray, "b 3"], high: Float[np.ndarray, "b 3"], i: int
) -> np.ndarray:
    """Whether the box of each body after the `i`th overlaps its box."""
    return ((low[i + 1 :] < high[i]) & (high[i + 1 :] > low[i])).all(axis=1)


def _overlap_share(a: ClosedBody, b: ClosedBody) -> float:
    intersection = manifold3d.Manifold.batch_boolean(
        [a.manifold, b.manifold], manifold3d.OpType.Intersect
    )
    # A body that crosses itself counts some of its room twice: no more than all is said.
    return min(intersection.volume() / min(a.manifold.volume(), b.manifold.volume()), 1.0)
