"""Intervals by cluster bootstrap, sign-flip tests, and Holm's correction."""

from dataclasses import replace
from itertools import product
from math import comb

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from industnerf.report.statistics import significance
from industnerf.report.statistics.significance import (
    bootstrap_interval,
    holm_correction,
    paired_change,
    sign_flip_p,
)
from industnerf.schema import ReportParams

SETTINGS = ReportParams(bootstrap_resamples=100, confidence_level=0.95, contact_sheet_parts=1)


def rng():
    return np.random.default_rng(0)


def test_equal_values_have_no_width():
    assert bootstrap_interval([2.0] * 6, list("aabbcc"), SETTINGS, 0) == (2.0, 2.0)


def test_one_part_a_family_is_the_plain_bootstrap():
    """Its standard error is that of a mean: 1.96 s / sqrt(n) either way."""
    values = np.random.default_rng(1).normal(size=400)
    families = [str(i) for i in range(400)]
    low, high = bootstrap_interval(
        list(values), families, replace(SETTINGS, bootstrap_resamples=4000), 0
    )
    expected = 1.96 * values.std() / np.sqrt(400)
    # 4000 draws place a 2.5 % quantile to about 5 % of the half-width (3 standard errors)
    assert (high - low) / 2 == pytest.approx(expected, rel=0.06)


def test_parts_of_a_family_do_not_count_as_independent():
    """Ten copies of every part in its family narrow nothing."""
    values, families = [float(i) for i in range(8)], [str(i) for i in range(8)]
    once = bootstrap_interval(values, families, SETTINGS, 0)
    tenfold = bootstrap_interval(values * 10, families * 10, SETTINGS, 0)
    assert once == pytest.approx(tenfold)


def test_one_family_has_no_interval():
    """Nor has its change, though its parts differ."""
    assert bootstrap_interval([1.0, 3.0, 2.0], ["a"] * 3, SETTINGS, 0) == (None, None)
    change = paired_change(
        {"p": 1.0, "q": 2.0}, {"p": 3.0, "q": 5.0}, dict.fromkeys("pq", "a"), SETTINGS, 0
    )
    assert (change.mean, change.low, change.high) == (2.5, None, None)


def test_a_change_is_that_of_the_parts_that_both_have():
    """One part a family, each 0.1 less: nothing is left to chance."""
    before = {"a": 0.5, "b": 0.7, "gone": 9.0}
    after = {"a": 0.4, "b": 0.6, "new": 0.0}
    change = paired_change(before, after, {"a": "x", "b": "y"}, SETTINGS, seed=0)
    assert (change.mean, change.low, change.high) == pytest.approx((-0.1, -0.1, -0.1))
    assert (change.parts, change.num_lower) == (2, 2)


def test_the_interval_of_a_change_is_that_of_the_differences():
    before, after = {"a": 1.0, "b": 2.0, "c": 3.0}, {"a": 1.5, "b": 1.0, "c": 3.0}
    families = {"a": "x", "b": "y", "c": "z"}
    change = paired_change(before, after, families, SETTINGS, seed=3)
    assert (change.low, change.high) == bootstrap_interval([0.5, -1.0, 0.0], "xyz", SETTINGS, 3)
    assert change.num_lower == 1


def test_without_a_part_in_common_there_is_no_change():
    assert paired_change({"a": 1.0}, {"b": 1.0}, {}, SETTINGS, seed=0) is None


def brute_force_p(differences, families):
    """All patterns of signs in a loop; every part is looked at in every pattern."""
    names = sorted(set(families))
    observed, extreme = abs(sum(differences)), 0
    for signs in product((1, -1), repeat=len(names)):
        sign = dict(zip(names, signs, strict=True))
        total = sum(sign[f] * d for f, d in zip(families, differences, strict=True))
        extreme += abs(total) >= observed
    return extreme / 2 ** len(names)


whole_numbers = st.integers(-20, 20)  # whole numbers add up exactly: ties are ties in any order


@given(st.lists(st.tuples(whole_numbers, st.sampled_from("abcdef")), min_size=1, max_size=12))
def test_the_p_value_is_that_of_a_loop_over_all_patterns(rows):
    differences, families = [float(d) for d, _ in rows], [f for _, f in rows]
    assert sign_flip_p(differences, families, rng()) == brute_force_p(differences, families)


def test_the_p_value_of_equal_differences_is_a_sign_tests():
    """k of n families differ by +1, the others by -1: both tails of the binomial distribution."""
    n, k = 16, 13
    differences = [1.0] * k + [-1.0] * (n - k)
    tails = 2 * sum(comb(n, i) for i in range(k, n + 1)) / 2**n
    assert sign_flip_p(differences, [str(i) for i in range(n)], rng()) == tails


def test_one_sided_families_have_the_least_p_and_one_family_proves_nothing():
    differences = [0.1, 0.3, 0.02, 0.4, 0.05, 0.6]
    assert sign_flip_p(differences, list("abcdef"), rng()) == 2 / 2**6
    assert sign_flip_p(differences, list("aabbcc"), rng()) == 2 / 2**3
    assert sign_flip_p(differences, ["a"] * 6, rng()) == 1
    assert sign_flip_p([0.0] * 6, list("abcdef"), rng()) == 1


def test_sums_that_differ_by_rounding_are_ties():
    """All signs, and none, are as far from 0 as what was found, in whatever order it was summed."""
    for seed in range(20):
        differences = np.random.default_rng(seed).uniform(0.1, 1, 10)
        assert sign_flip_p(list(differences), list("abcdefghij"), rng()) == 2 / 2**10


def test_neither_scale_nor_sign_nor_order_of_the_parts_moves_p():
    values = np.random.default_rng(2).normal(0.3, 1, 30)
    families = [str(i % 9) for i in range(30)]
    p = sign_flip_p(list(values), families, rng())
    assert sign_flip_p(list(-1e-3 * values), families, rng()) == p
    assert sign_flip_p(list(values[::-1]), families[::-1], rng()) == p


def test_drawn_patterns_agree_with_all_of_them(monkeypatch):
    values = list(np.random.default_rng(3).normal(0.4, 1, 12))
    families = [str(i) for i in range(12)]
    exact = sign_flip_p(values, families, rng())
    monkeypatch.setattr(significance, "MAX_EXACT_FAMILIES", 11)
    estimated = sign_flip_p(values, families, rng())
    # four standard errors of a share of so many draws
    assert estimated == pytest.approx(
        exact, abs=4 * (exact * (1 - exact) / significance.SIGN_FLIP_DRAWS) ** 0.5
    )
    assert estimated != exact
    assert estimated == sign_flip_p(values, families, rng())


def test_a_drawn_p_is_never_0():
    """Of 2**60 patterns two are as far from 0: none is drawn, but the one found counts."""
    p = sign_flip_p([1.0] * 60, [str(i) for i in range(60)], rng())
    assert p == 1 / (1 + significance.SIGN_FLIP_DRAWS)


def test_holm_by_hand():
    """4 x 0.01, then 3 x 0.013 is less and stays there, 2 x 0.03 and 1 x 0.9."""
    assert holm_correction([0.03, 0.01, 0.9, 0.013]) == pytest.approx([0.06, 0.04, 0.9, 0.04])
    assert holm_correction([0.5, 0.6]) == [1.0, 1.0]
    assert holm_correction([]) == []


@given(st.lists(st.floats(0, 1), min_size=1, max_size=12), st.floats(0.001, 0.999))
def test_holm_rejects_what_the_step_down_procedure_does(p_values, level):
    """Holm's own wording: go on, from the smallest, until one p exceeds level / (tests left)."""
    rejected = []
    for i in sorted(range(len(p_values)), key=p_values.__getitem__):
        if (len(p_values) - len(rejected)) * p_values[i] > level:
            break
        rejected.append(i)
    assert [i for i, p in enumerate(holm_correction(p_values)) if p <= level] == sorted(rejected)
