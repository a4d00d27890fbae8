"""Random choices of a designer: proportions, numbers, yes or no, from one stream."""

from collections.abc import Sequence
from typing import TypeVar

import numpy as np
from jaxtyping import Float

T = TypeVar("T")
Real = float | int
Numbers = Float[np.ndarray, "*any"] | float
GRID = 2.0**-20
"""Coordinates are multiples of it: the last bits of a sine differ between mathematical libraries,
and what a solid looks like must not hang on them."""

_BOXES = {  # ranges of the three edges
    "block": ((0.5, 1.0), (0.5, 1.0), (0.4, 1.0)),
    "slab": ((0.6, 1.2), (0.5, 1.0), (0.15, 0.4)),
    "plate": ((0.7, 1.4), (0.5, 1.2), (0.04, 0.15)),
    "beam": ((1.2, 2.4), (0.15, 0.5), (0.15, 0.5)),
}


def on_grid(values: Numbers) -> Numbers:
    """`values` rounded to multiples of `GRID`."""
    return np.round(values / GRID) * GRID


def cosine(turn: Numbers) -> Numbers:
    """Of an angle in radians, to 40 bits: half of 1 is half of 1 everywhere."""
    return np.round(np.cos(turn) * 2.0**40) / 2.0**40


def sine(turn: Numbers) -> Numbers:
    """Of an angle in radians, to 40 bits."""
    return np.round(np.sin(turn) * 2.0**40) / 2.0**40


class Sampler:
    """Random numbers from one generator; each is a multiple of `GRID`."""

    def __init__(self, rng: np.random.Generator) -> None:
        self._rng = rng

    def uniform(self, low: Real, high: Real) -> float:
        return float(on_grid(self._rng.uniform(low, high)))

    def uniforms(self, low: Real, high: Real, *shape: int) -> Float[np.ndarray, "*shape"]:
        return on_grid(self._rng.uniform(low, high, shape))

    def log_uniform(self, low: Real, high: Real) -> float:
        """As often between 1 and 2 as between 2 and 4."""
        return float(on_grid(low * (high / low) ** self._rng.uniform()))

    def integer(self, low: int, high: int) -> int:
        """From `low` to `high`, both included."""
        return int(self._rng.integers(low, high + 1))

    def chance(self, probability: Real) -> bool:
        return bool(self._rng.uniform() < probability)

    def pick(self, options: Sequence[T]) -> T:
        return options[self.integer(0, len(options) - 1)]

    def order(self, n: int) -> list[int]:
        """The numbers 0 to n - 1, shuffled."""
        return self._rng.permutation(n).tolist()

    def box(self, *forms: str) -> tuple[float, float, float]:
        """Edges of a box of one of `forms` ("block", "slab", "plate", "beam"; all by default)."""
        x, y, z = (self.uniform(*edge) for edge in _BOXES[self.pick(forms or tuple(_BOXES))])
        return x, y, z

    def sign(self) -> int:
        return 1 if self.chance(0.5) else -1
