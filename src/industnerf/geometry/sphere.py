"""Even directions on the unit sphere."""

import numpy as np
from jaxtyping import Float

GOLDEN_ANGLE = np.pi * (3 - np.sqrt(5))


def fibonacci_sphere(n: int, azimuth_rad: float = 0.0) -> Float[np.ndarray, "n 3"]:
    """`n` unit vectors on the Fibonacci lattice, from near +z to near -z.

    `azimuth_rad` rotates the lattice about z, so that two lattices can be kept apart.
    """
    return _lattice(n, 1.0, azimuth_rad)


def fibonacci_hemisphere(n: int, azimuth_rad: float = 0.0) -> Float[np.ndarray, "n 3"]:
    """The same over the upper half, from near +z to near the horizon."""
    return _lattice(n, 0.5, azimuth_rad)


def _lattice(n: int, z_span: float, azimuth_rad: float) -> Float[np.ndarray, "n 3"]:
    i = np.arange(n)
    z = 1 - z_span * (2 * i + 1) / n  # equal-area rings: Archimedes' hat box
    ring_radius, angle = np.sqrt(1 - z * z), GOLDEN_ANGLE * i + azimuth_rad
    return np.stack([ring_radius * np.cos(angle), ring_radius * np.sin(angle), z], axis=1)
