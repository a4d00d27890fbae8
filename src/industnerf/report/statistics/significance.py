"""Intervals and tests of means over parts; parts of one family are not independent."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import fmean

import numpy as np
from jaxtyping import Float

from industnerf.schema import ReportParams
from industnerf.seeds import generator

MAX_EXACT_FAMILIES = 20  # up to here all patterns of signs are tried: 2**20 sums are 8 MB
SIGN_FLIP_DRAWS = 65_536  # patterns drawn where there are more families
BOOTSTRAP_SEED = 0  # of intervals over points of a sweep, which may differ in their seeds
Interval = tuple[float, float] | tuple[None, None]  # low and high; None: there is no interval


def bootstrap_interval(
    values: Sequence[float], families: Sequence[str], settings: ReportParams, seed: int
) -> Interval:
    """Percentile interval (low, high) of the mean under a cluster bootstrap.

    Whole families are drawn with replacement, the same ones for every method; a draw's mean is over
    all its parts. One family varies in no draw and has no interval.
    """
    if len(set(families)) < 2:
        return None, None
    sums, counts = _by_family(values, families)
    rng = generator(seed, "bootstrap")
    family_draws = rng.integers(len(sums), size=(settings.bootstrap_resamples, len(sums)))
    means = sums[family_draws].sum(axis=1) / counts[family_draws].sum(axis=1)
    tail = (1 - settings.confidence_level) / 2
    low, high = np.quantile(means, [tail, 1 - tail])
    return float(low), float(high)


@dataclass(frozen=True)
class PairedChange:
    """The mean difference of the same parts under two settings, with its interval."""

    mean: float
    low: float | None  # of the interval; None where there is none
    high: float | None
    parts: int
    num_lower: int  # parts that score less than before


def paired_change(
    before: Mapping[str, float],
    after: Mapping[str, float],
    families: Mapping[str, str],
    settings: ReportParams,
    seed: int,
) -> PairedChange | None:
    """`after` less `before`, part by part, of all parts that have both; None if none has.

    A hard part is hard under both settings, so the interval is narrower than those of the means.
    """
    parts = sorted(before.keys() & after.keys())
    if not parts:
        return None
    changes = [after[part] - before[part] for part in parts]
    interval = bootstrap_interval(changes, [families[part] for part in parts], settings, seed)
    return PairedChange(
        fmean(changes), *interval, len(parts), sum(change < 0 for change in changes)
    )


def sign_flip_p(
    differences: Sequence[float], families: Sequence[str], rng: np.random.Generator
) -> float:
    """Two-sided p-value of the paired permutation test of a mean difference of 0.

    If two methods are alike, either sign of a difference is as likely. The differences of a family
    flip together. p is the share of the sign patterns whose mean is at least as far from 0 as the
    observed one: of all 2**families patterns up to MAX_EXACT_FAMILIES, else of SIGN_FLIP_DRAWS
    drawn ones and the observed one, so that p is never 0 (Phipson and Smyth, 2010).
    """
    sums, _ = _by_family(differences, families)
    observed = abs(sums.sum()) - 1e-12 * np.abs(sums).sum()  # sums in another order round otherwise
    if len(sums) <= MAX_EXACT_FAMILIES:
        return float(np.mean(np.abs(_all_flips(sums)) >= observed))
    flipped = rng.choice([-1.0, 1.0], size=(SIGN_FLIP_DRAWS, len(sums))) @ sums
    return float((1 + np.sum(np.abs(flipped) >= observed)) / (1 + SIGN_FLIP_DRAWS))


def holm_correction(p_values: Sequence[float]) -> list[float]:
    """The p-values adjusted for multiple tests (Holm, 1979), in the order given.

    It bounds the family-wise error rate, however the tests depend on each other.
    """
    ascending = np.argsort(p_values, kind="stable")
    factors = np.arange(len(p_values), 0, -1)  # the smallest competes with all, the largest alone
    monotone = np.minimum(1, np.maximum.accumulate(factors * np.asarray(p_values)[ascending]))
    adjusted = np.empty(len(p_values))
    adjusted[ascending] = monotone
    return adjusted.tolist()


def _by_family(
    values: Sequence[float], families: Sequence[str]
) -> tuple[Float[np.ndarray, "f"], Float[np.ndarray, "f"]]:
    """The sum of the values of each family, and how many there are."""
    _, index = np.unique(list(families), return_inverse=True)
    return np.bincount(index, weights=values), np.bincount(index).astype(np.float64)


def _all_flips(sums: Float[np.ndarray, "f"]) -> Float[np.ndarray, "patterns"]:
    """The sum of `sums` under every pattern of signs."""
    totals = np.zeros(1)
    for each in sums:
        totals = np.concatenate([totals + each, totals - each])
    return totals
