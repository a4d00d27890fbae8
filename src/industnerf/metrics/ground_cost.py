"""The ground cost of transport: what it costs to carry mass over a distance."""

import math
import sys
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64
from scipy.spatial.distance import cdist

from industnerf.errors import MetricError


@dataclass(frozen=True)
class GroundCost:
    """The Euclidean distance, or its square; the cheapest plan costs W1, or W2 squared.

    All costs come from differences of coordinates: no digits are lost where points lie close.
    """

    squared: bool

    def from_squared(
        self, squared_distances: Float64[np.ndarray, "*any"]
    ) -> Float64[np.ndarray, "*any"]:
        """The costs of squared distances, which are overwritten."""
        if self.squared:
            return squared_distances
        return np.sqrt(squared_distances, out=squared_distances)

    def lower_bound(self, distance: Float64[np.ndarray, "*any"]) -> Float64[np.ndarray, "*any"]:
        """A lower bound of the cost from one of the distance, which may be below 0."""
        return np.square(np.maximum(distance, 0.0)) if self.squared else distance

    def tangent(
        self, differences: Float64[np.ndarray, "k 3"]
    ) -> tuple[Float64[np.ndarray, "k"], Float64[np.ndarray, "k 3"]]:
        """The cost at each difference d of two points, and its slope c'(d).

        The cost is convex: nowhere is it below c(d) + c'(d) (x - d).
        """
        if self.squared:
            return np.square(differences).sum(axis=1), 2 * differences
        lengths = np.sqrt(np.square(differences).sum(axis=1))
        is_long = lengths[:, None] > 0  # at 0 itself the slope 0 will do
        slopes = np.divide(
            differences, lengths[:, None], out=np.zeros_like(differences), where=is_long
        )
        return lengths, slopes

    def rowwise(
        self, a: Float64[np.ndarray, "k 3"], b: Float64[np.ndarray, "k 3"]
    ) -> Float64[np.ndarray, "k"]:
        """The cost of every pair of rows."""
        return self.from_squared(np.square(a - b).sum(axis=1))

    def matrix(
        self, a: Float64[np.ndarray, "n 3"], b: Float64[np.ndarray, "m 3"]
    ) -> Float64[np.ndarray, "n m"]:
        """The costs from all points to all."""
        return cdist(a, b, "sqeuclidean" if self.squared else "euclidean")

    def between_cells(
        self, p: Float64[np.ndarray, "cells s 3"], q: Float64[np.ndarray, "cells t 3"]
    ) -> Float64[np.ndarray, "cells s t"]:
        """The costs within each pair of cells."""
        total = np.zeros((len(p), p.shape[1], q.shape[1]))
        for axis in range(3):
            difference = p[:, :, None, axis] - q[:, None, :, axis]
            total += np.square(difference, out=difference)
        return self.from_squared(total)

    def of_length(self, length: float) -> float:
        """What it costs to carry a unit of mass over `length`, a power of two.

        Raises MetricError if the square is no number of float64 with all its digits.
        """
        if not self.squared:
            return length
        if not sys.float_info.min <= length * length < math.inf:
            raise MetricError(
                f"the square of a length of about {length:g} does not fit into float64"
            )
        return length * length


EUCLIDEAN, SQUARED_EUCLIDEAN = GroundCost(squared=False), GroundCost(squared=True)
