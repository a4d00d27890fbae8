"""How a cost grows with what is swept: a power law, fitted by least squares in logarithms."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class PowerLaw:
    """y = factor * x**exponent; `error` is the exponent's standard error, of `points` points."""

    exponent: float
    error: float
    factor: float
    points: int


def power_law(x: Sequence[int | float], y: Sequence[int | float]) -> PowerLaw | None:
    """The power law nearest to the points in log-log, each point counting alike.

    Points that have no logarithm are left out.  None where fewer than three remain, or all at one
    x: with two there is no error to be known.
    """
    points = np.array([pair for pair in zip(x, y, strict=True) if min(pair) > 0], float)
    if len(points) < 3 or np.ptp(points[:, 0]) == 0:
        return None
    u, v = np.log(points).T
    sum_of_squares = float(((u - u.mean()) ** 2).sum())
    exponent = float(((u - u.mean()) * (v - v.mean())).sum()) / sum_of_squares
    offset = float(v.mean() - exponent * u.mean())
    residual = float(((v - offset - exponent * u) ** 2).sum())
    error = float(np.sqrt(residual / (len(points) - 2) / sum_of_squares))
    return PowerLaw(exponent, error, float(np.exp(offset)), len(points))
