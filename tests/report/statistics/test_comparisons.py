"""Which methods are compared, on which parts, and what is said of them."""

import csv
import io

import pytest

from industnerf.methods import load_method
from industnerf.report.statistics.comparisons import (
    COLUMNS,
    NO_COMPARISONS,
    compare_methods,
    comparisons_csv,
    comparisons_md,
    format_row,
    method_pairs,
    net_pairs,
)
from industnerf.report.study import TrainingSummary
from tests.samples import unit_part
from tests.studies import SETTINGS, make_study

PARTS = [unit_part(name, family) for name, family in zip("abcdefg", "ffghijk", strict=True)]
PLUS = [0.02, 0.04, 0.02, 0.02, 0.02, 0.02, 9.0]
HULL = [0.03, 0.03, 0.05, 0.06, 0.07, 0.08, 0.0]


@pytest.fixture
def study():
    """Six test parts of five families, the first two of one; g is a dev part."""
    emds = {"hull": HULL, "oracle": [0.01] * 7, "industnerf_plus": PLUS}
    return make_study(PARTS, emds, dev="g")


def test_ours_meet_every_method_once_and_no_reference():
    names = ["industnerf", "r2n2", "industnerf_plus", "hull", "ball", "oracle", "tsdf"]
    assert method_pairs(map(load_method, names)) == [
        ("industnerf_plus", "industnerf"),
        ("industnerf_plus", "r2n2"),
        ("industnerf_plus", "hull"),
        ("industnerf", "r2n2"),
        ("industnerf", "hull"),
    ]


def test_a_comparison_is_of_the_test_parts_by_family(study):
    (results,) = compare_methods(study, SETTINGS)
    assert (results.method, results.other) == ("industnerf_plus", "hull")
    assert results.difference == pytest.approx((0 - 0.03 - 0.04 - 0.05 - 0.06) / 6)
    assert results.ci_low < results.difference < results.ci_high
    assert results.win_rate == 5 / 6
    assert (results.parts, results.families) == (6, 5)
    # in family f the differences cancel, so flipping it changes nothing: 2 of 16 patterns
    assert results.p == 2 / 16


def test_a_failure_counts_with_its_score(study):
    worse = make_study(PARTS, {"hull": HULL, "industnerf_plus": [float("inf"), *PLUS[1:]]}, dev="g")
    (results,) = compare_methods(worse, SETTINGS)
    assert results.win_rate == 4 / 6
    assert results.difference == pytest.approx((0.97 + 0.01 - 0.03 - 0.04 - 0.05 - 0.06) / 6)


def test_all_comparisons_are_corrected_together():
    emds = {"hull": HULL, "industnerf": [0.1] * 7, "industnerf_plus": PLUS}
    results = compare_methods(make_study(PARTS, emds, dev="g"), SETTINGS)
    assert {each.p for each in results} == {2 / 16, 2 / 32}
    # against each other and against the hull every family points one way: 2 of 32 patterns
    assert {(each.p, each.p_holm) for each in results} == {(2 / 32, 6 / 32), (2 / 16, 6 / 32)}


def test_a_net_meets_what_it_must_beat_as_a_question_of_its_own():
    emds = {"hull": HULL, "industnerf_plus": PLUS, "r2n2": PLUS, "retrieval": HULL}
    training_summaries = {
        "r2n2": TrainingSummary("cpu", 78, "family", True),
        "retrieval": TrainingSummary("", 78, "family", True),
    }
    study = make_study(PARTS, emds, dev="g", training_summaries=training_summaries)
    assert net_pairs(study) == [("r2n2", "retrieval")]
    *_, last = compare_methods(study, SETTINGS)
    assert (last.method, last.other) == ("r2n2", "retrieval")
    assert last.p_holm == last.p == 2 / 16


def test_the_files_hold_what_the_comparisons_do(study):
    results = compare_methods(study, SETTINGS)
    (row,) = csv.DictReader(io.StringIO(comparisons_csv(results)))
    assert list(row) == list(vars(results[0]))
    assert (row["p"], row["win_rate"], row["families"]) == ("0.125", "0.833333", "5")
    head, _, line = comparisons_md(results, 0.9).splitlines()
    assert "| 90 % |" in head
    assert line.startswith("| industnerf_plus | hull | -0.0300 |")
    assert line.endswith("| -0.05 | 0.12 | 0.12 | 83 % | 6 in 5 families |")


def test_of_one_family_there_is_no_interval(study):
    (results,) = compare_methods(study, SETTINGS)
    assert " to " in format_row(results)[COLUMNS.index("95 %")]
    pair = make_study(PARTS[:2], {"hull": HULL[:2], "industnerf_plus": PLUS[:2]})
    (alone,) = compare_methods(pair, SETTINGS)
    assert (alone.ci_low, alone.ci_high) == (None, None)
    assert format_row(alone)[COLUMNS.index("95 %")] == ""


def test_with_nothing_to_compare_it_says_so():
    lonely = make_study(PARTS, {"hull": HULL, "oracle": HULL})
    untested = make_study(PARTS, {"hull": HULL, "industnerf": PLUS}, dev="abcdefg")
    for study in (lonely, untested):
        assert compare_methods(study, SETTINGS) == []
    assert comparisons_md([], 0.9) == f"{NO_COMPARISONS}\n"
    assert len(comparisons_csv([]).splitlines()) == 1
