"""Randomness is asked for by name."""

import hashlib

import numpy as np


def seed_for(base: int, *purpose: str) -> int:
    """A 32-bit seed that depends on `base` and the whole `purpose`, and on nothing else.

    Adding a part, a method or a call elsewhere cannot shift it, unlike a shared generator.
    """
    text = "/".join([str(base), *purpose])
    return int.from_bytes(hashlib.sha256(text.encode()).digest()[:4], "big")


def generator(base: int, *purpose: str) -> np.random.Generator:
    """A generator seeded by `seed_for(base, *purpose)`."""
    return np.random.default_rng(seed_for(base, *purpose))
