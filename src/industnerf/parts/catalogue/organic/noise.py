"""Smooth noise without a lattice: a seeded sum of plane waves."""

import numpy as np
from jaxtyping import Float

from industnerf.parts.catalogue.organic.forms import Points


def plane_wave_noise(
    points: Points, seed: int, length_mm: float, octaves: int
) -> Float[np.ndarray, "n"]:
    """sum_o 2^-o / sqrt(12) sum_k sin(2^o a_k . p + b_k): 24 random waves an octave.

    The longest are of about `length_mm`; the sum has a standard deviation of about 1.
    """
    rng = np.random.default_rng(seed)
    total = np.zeros(len(points))
    for octave in range(octaves):
        wave_vectors = rng.normal(size=(24, 3)) * 2**octave * 2 * np.pi / length_mm / 3**0.5
        phase = rng.uniform(0, 2 * np.pi, 24)
        total += np.sin(points @ wave_vectors.T + phase).sum(axis=1) / 12**0.5 / 2**octave
    return total
