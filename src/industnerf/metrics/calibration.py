"""Calibration of confidence: whether confident points are accurate.

Computed over the candidates near the surface alone, for far off it confidence is bound to be low
and any order looks good.  Points of equal confidence have no order: each counts as the mean of what
every order of them would give, so a confidence that is the same everywhere is as good as chance.
"""

import numpy as np
from jaxtyping import Float


def spearman(a: Float[np.ndarray, "n"], b: Float[np.ndarray, "n"]) -> float:
    """Correlation of the ranks, in [-1, 1]; ties share their mean rank.  0 if all are tied."""
    from scipy.stats import rankdata  # late: it takes a second to import

    ranks = [rankdata(values) - (len(values) + 1) / 2 for values in (a, b)]
    spread = np.sqrt((ranks[0] ** 2).sum() * (ranks[1] ** 2).sum())
    return float((ranks[0] * ranks[1]).sum() / spread) if spread else 0.0


def sparsification(
    error: Float[np.ndarray, "n"], order: Float[np.ndarray, "n"]
) -> Float[np.ndarray, "n"]:
    """Mean error of the points that are left after 0, 1, ... n - 1 are removed, in units of that
    of all; those of the lowest `order` go first."""
    _, group = np.unique(order, return_inverse=True)
    expected = (np.bincount(group, error) / np.bincount(group))[group]
    ascending = expected[np.argsort(order, kind="stable")]
    remaining = ascending[::-1].cumsum()[::-1] / np.arange(len(error), 0, -1)
    return remaining / error.mean()


def sparsification_at(
    error: Float[np.ndarray, "n"], order: Float[np.ndarray, "n"], removed: Float[np.ndarray, "s"]
) -> Float[np.ndarray, "s"]:
    """The sparsification curve after the shares `removed`, each below 1; 0 if there is no error."""
    if not error.any():
        return np.zeros_like(removed)
    return sparsification(error, order)[(removed * len(error)).astype(int)]


def ause(error: Float[np.ndarray, "n"], confidence: Float[np.ndarray, "n"]) -> float:
    """Area between the sparsification curves by confidence and by the true error.

    0 if the confidence orders the points as their errors do -- Ilg et al. (2018), section 6.2;
    0 too where no point has an error.
    """
    if not error.any():
        return 0.0
    return float((sparsification(error, confidence) - sparsification(error, -error)).mean())


def random_ause(error: Float[np.ndarray, "n"]) -> float:
    """Expected AUSE of a random order, whose curve stays at 1."""
    return ause(error, np.zeros_like(error))
