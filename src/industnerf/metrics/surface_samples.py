"""Samples of a surface, true or predicted, and which of them count."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float

from industnerf.geometry.sampling import sample_surface
from industnerf.metrics.reference_rig import ReferenceRig, ReferenceSurface
from industnerf.metrics.subsample import farthest_points
from industnerf.schema import EvaluateParams
from industnerf.seeds import generator


@dataclass(frozen=True)
class SampledSurface:
    """Points in diagonals, and which of them are compared with the visible surface.

    What is derived from them is kept: one truth is compared with many clouds.
    """

    points: Float[np.ndarray, "n 3"]
    evaluated: Bool[np.ndarray, "n"]

    @cached_property
    def visible_points(self) -> Float[np.ndarray, "m 3"]:
        """Those that are compared with the visible surface."""
        return self.points[self.evaluated]

    def even_points(self, count: int, *, only_visible: bool) -> Float[np.ndarray, "k 3"]:
        """`farthest_points` of all, or of the visible ones."""
        key = count, only_visible
        if key not in self._even_points:
            points = self.visible_points if only_visible else self.points
            self._even_points[key] = farthest_points(points, count)
        return self._even_points[key]

    @cached_property
    def _even_points(self) -> dict[tuple[int, bool], Float[np.ndarray, "_ 3"]]:
        return {}


def sample_reference(
    name: str, reference: ReferenceSurface, settings: EvaluateParams, seed: int, use: str
) -> tuple[Float[np.ndarray, "n 3"], SampledSurface]:
    """Samples of the surface of the part `name`, in mm and in diagonals.

    `use` is `scored`, of the truth itself, or `floor`, of what a perfect method would return.
    """
    rng = generator(seed, "truth", use, name)
    points, _ = sample_surface(
        reference.mesh.vertices, reference.mesh.faces, settings.dense_samples, rng
    )
    return points, SampledSurface(
        reference.normalize(points), ReferenceRig(reference, settings).is_visible(points)
    )
