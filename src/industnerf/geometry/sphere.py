"""Even directions on the unit sphere."""

import numpy as np
from jaxtyping import Float

GOLDEN_ANGLE = np.pi * (3 - np.sqrt(5))


def fibonacci_sphere(n: int, turn: float = 0.0) -> Float[np.ndarray, "n 3"]:
    """`n` unit vectors on the Fibonacci lattice, from near +z to near -z.

    `turn` (radians) rotates the lattice about z, so that two lattices can be kept apart.
    """
    return _lattice(n, 1.0, turn)


def fibonacci_hemisphere(n: int, turn: float = 0.0) -> Float[np.ndarray, "n 3"]:
    """The same over the upper half, from near +z to near the horizon."""
    return _lattice(n, 0.5, turn)


def _lattice(n: int, share: float, turn: float) -> Float[np.ndarray, "n 3"]:
    i = np.arange(n)
    z = 1 - share * (2 * i + 1) / n  # equal-area rings: Archimedes' hat box
    ring, angle = np.sqrt(1 - z * z), GOLDEN_ANGLE * i + turn
    return np.stack([ring * np.cos(angle), ring * np.sin(angle), z], axis=1)
