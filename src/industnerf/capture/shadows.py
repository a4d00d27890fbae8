"""Soft shadows: how much of a lamp, a disc in the sky, a spot on the surface sees."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Float32

from industnerf.capture.edges import sample_pattern
from industnerf.capture.surface import Spots, Surface
from industnerf.geometry.cameras import look_at

CLEAR = 1e-4  # how far above the surface a shadow ray begins, in sizes of the part
PROBES = 4  # rays that decide whether the others of a lamp are needed

Points = Float32[np.ndarray, "points 3"]


class Lit(NamedTuple):
    """What spots see of one lamp."""

    share: Float32[np.ndarray, "n"]  # of the disc
    cosine: Float32[np.ndarray, "n"]  # to the normal, mean over the disc; 0 for what is hidden


class Shadows:
    """Rays towards fixed points of every lamp: no chance, hence no noise and no seed.

    The `PROBES` points nearest to the rim of a lamp's disc are looked at first.  Where they agree
    the others are taken to agree with them: a wire thin enough to hide the middle alone is missed.
    """

    def __init__(self, surface: Surface, lamp_deg: float, samples: int) -> None:
        self._surface, self._samples = surface, samples
        self._reach = np.tan(np.radians(lamp_deg))
        self._clear_mm = CLEAR * float(np.ptp(surface.vertices, axis=0).max())

    def starts(self, spots: Spots, normal: Float32[np.ndarray, "3 n"]) -> Float[np.ndarray, "n 3"]:
        """Where the shadow rays of `spots` begin, mm; `normal` has unit length."""
        return self._surface.lifted(spots) + self._clear_mm * normal.T

    def lit(
        self,
        starts: Float[np.ndarray, "n 3"],
        normal: Float32[np.ndarray, "3 n"],
        towards: Float32[np.ndarray, "3"],
    ) -> Lit:
        """What is seen from `starts` of the lamp around `towards`, above each one's horizon."""
        disc = disc_around(towards, self._reach, self._samples)
        cosine = np.maximum(disc @ normal, 0)
        seen = cosine > 0
        above = np.flatnonzero(seen.any(axis=0))
        seen[-PROBES:, above] &= self._clear(starts[above], disc[-PROBES:])
        agreed = seen[-PROBES:, above].mean(axis=0)
        seen[:, above[agreed == 0]] = False
        torn = above[(agreed > 0) & (agreed < 1)]
        seen[:-PROBES, torn] &= self._clear(starts[torn], disc[:-PROBES])
        cosine *= seen
        return Lit(seen.mean(axis=0, dtype=np.float32), cosine.mean(axis=0))

    def _clear(
        self, starts: Float[np.ndarray, "m 3"], points: Points
    ) -> Bool[np.ndarray, "points m"]:
        """Whether each point of the lamp is seen from each of `starts`."""
        clear = np.empty((len(points), len(starts)), bool)
        for row, point in zip(clear, points, strict=True):
            row[:] = ~self._surface.scene.blocked(starts, np.tile(point, (len(starts), 1)))
        return clear


def disc_around(towards: Float32[np.ndarray, "3"], reach: float, samples: int) -> Points:
    """Unit vectors to points, even in area, of a disc of radius `reach` at the distance 1.

    They come from its middle to its rim, and any four in a row stand on four sides of it.
    """
    share, turn = sample_pattern(samples).T.astype(np.float64)
    angle, out = 2 * np.pi * turn, reach * np.sqrt(share)
    # as a camera in the middle would see it: the lamp's own right and down
    across = look_at(np.zeros((1, 3)), towards.astype(np.float64))[0, :3, :2]
    points = towards + (out * np.stack([np.cos(angle), np.sin(angle)])).T @ across.T
    return (points / np.linalg.norm(points, axis=1, keepdims=True)).astype(np.float32)
