"""Cameras of a turntable: the same elevations all round, some elevations one above the other."""

import numpy as np
from jaxtyping import Float

Elevations = Float[np.ndarray, "rings"]  # radians


def ring_directions(count: int, elevations: Elevations) -> Float[np.ndarray, "{count} 3"]:
    """`count` unit vectors, ring by ring.

    The rings share them as evenly as possible, the first having one more; each ring is evenly
    spaced, and turned by its part of a step, so that no two rings of equally many cameras have
    any at one azimuth.
    """
    azimuths = [
        (np.arange(n) + ring / len(elevations)) / max(n, 1)
        for ring, n in enumerate(split_evenly(count, len(elevations)))
    ]
    return _unit_vectors(elevations, azimuths)


def held_out_directions(
    count: int, held_out: int, elevations: Elevations
) -> Float[np.ndarray, "{held_out} 3"]:
    """`held_out` unit vectors on the rings of `count` others, in the middles of their gaps.

    Where a ring has more of them than gaps, they divide its gaps evenly.
    """
    azimuths, levels = [], len(elevations)
    per_ring = zip(split_evenly(count, levels), split_evenly(held_out, levels), strict=True)
    for ring, (gaps, n) in enumerate(per_ring):
        gaps = max(gaps, 1)
        slots_per_gap = -(-n // gaps)  # in a gap
        # the rings begin at different gaps, so that they do not leave the same side out
        slot = ((np.arange(n) + ring / levels) * (gaps * slots_per_gap) / max(n, 1)).astype(int)
        gap, slot_in_gap = slot // max(slots_per_gap, 1), slot % max(slots_per_gap, 1)
        azimuths.append((gap + (slot_in_gap + 1) / (slots_per_gap + 1) + ring / levels) / gaps)
    return _unit_vectors(elevations, azimuths)


def split_evenly(count: int, levels: int) -> list[int]:
    """`count` in `levels` whole parts that differ by one at most."""
    return [count // levels + (level < count % levels) for level in range(levels)]


def _unit_vectors(
    elevations: Elevations, azimuths: list[Float[np.ndarray, "_"]]
) -> Float[np.ndarray, "_ 3"]:
    """Unit vectors of every ring's azimuths, which are in turns."""
    elevation = np.repeat(elevations, [len(ring) for ring in azimuths])
    angle = 2 * np.pi * np.concatenate(azimuths)
    return np.stack(
        [np.cos(elevation) * np.cos(angle), np.cos(elevation) * np.sin(angle), np.sin(elevation)],
        axis=1,
    )
