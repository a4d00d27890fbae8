"""Table 1: what enters a mean, and what does not."""

import csv
import io
from dataclasses import replace
from pathlib import Path

import pytest

from industnerf.artifacts.scores import PartScore, Score
from industnerf.artifacts.split import SplitAssignment
from industnerf.methods import load_method
from industnerf.report.study import InputViews, Study, StudyFolders, TrainingSummary
from industnerf.report.tables.formats import format_fixed
from industnerf.report.tables.scores import scores_csv
from industnerf.report.tables.table1 import mean_without_failures, table1_rows
from industnerf.report.tables.table1_format import (
    COLUMNS,
    SEEDS_COLUMN,
    Table1Extra,
    format_row,
    table1_csv,
    table1_md,
)
from industnerf.schema import ReportParams
from tests.samples import unit_part

SETTINGS = ReportParams(bootstrap_resamples=200, confidence_level=0.95, contact_sheet_parts=4)
PROTOCOLS = ("P1-even", "P1-iid", "P1-full")


def scores(method, values, failed=()):
    """EMDs of parts a, b, ...: `P1-iid` is 0.1 more than `P1-even`, `P1-full` 0.2 more."""
    return [
        PartScore(
            name,
            method,
            Score(
                "emd",
                protocol,
                value + 0.1 * i,
                0.01,
                "diagonal",
                "failed" if name in failed else "ok",
            ),
        )
        for name, value in zip("abcd", values, strict=True)
        for i, protocol in enumerate(PROTOCOLS)
    ]


@pytest.fixture
def study():
    """Three test parts of two families and a dev part; the hull failed on one."""
    nowhere = Path("nowhere")
    return Study(
        preset="smoke",
        seed=0,
        num_train_views=12,
        methods={name: load_method(name) for name in ("hull", "oracle")},
        parts={name: unit_part(name, family) for name, family in zip("abcd", "ffgg", strict=True)},
        assignments={
            name: SplitAssignment("dev" if name == "d" else "test", None) for name in "abcd"
        },
        scores=scores("hull", [0.02, 0.04, 0.3, 9.0], failed="c") + scores("oracle", [0.01] * 4),
        failures={},
        input_warnings={},
        parameters_and_steps={"hull": (0, 0), "oracle": (0, 0)},
        training_summaries={},
        train_visible_share={},
        rig_visible_share={},
        folders=StudyFolders.all_at(nowhere),
        input_views=dict.fromkeys(("hull", "oracle"), InputViews(12)),
        seeds_sd={},
        empty_predictions={},
    )


def test_a_headline_mean_holds_the_test_parts_failures_included(study):
    rows = {(row.method, row.split): row for row in table1_rows(study, SETTINGS)}
    hull = rows["hull", "test"]
    assert hull.emd_even == pytest.approx((0.02 + 0.04 + 0.3) / 3)
    assert hull.emd_iid == pytest.approx(hull.emd_even + 0.1)
    assert hull.emd_full == pytest.approx(hull.emd_even + 0.2)
    assert (hull.parts, hull.failures) == (3, 1)
    assert hull.ratio_to_floor == pytest.approx(hull.emd_even / 0.01)
    assert mean_without_failures(study, hull) == pytest.approx(0.03)
    assert rows["hull", "dev"].emd_even == 9.0
    assert hull.ci_low <= hull.emd_even <= hull.ci_high


def test_reported_parts_come_first_and_the_best_method_leads(study):
    order = [(row.split, row.method) for row in table1_rows(study, SETTINGS)]
    assert order == [("test", "oracle"), ("test", "hull"), ("dev", "oracle"), ("dev", "hull")]


def test_a_bound_says_that_it_is_one(study):
    inputs = {row.method: row.inputs for row in table1_rows(study, SETTINGS)}
    assert inputs == {"oracle": "own mesh (bound)", "hull": "mask"}


def test_the_files_hold_what_the_rows_do(study):
    rows = table1_rows(study, SETTINGS)
    rows[1] = replace(rows[1], emd_even=0.01574974)  # with six decimals, and then with four: 0.0158
    read = list(csv.DictReader(io.StringIO(table1_csv(rows))))
    assert [row["method"] for row in read] == [row.method for row in rows]
    assert format_fixed(float(read[1]["emd_even"])) == "0.0157"
    assert read[1]["paper_emd"] == ""
    text = table1_md(rows, [Table1Extra(None, 1.5)] * len(rows), 0.9)
    assert "90 %" in text.splitlines()[0]
    assert "| 1.50 |" in text
    assert SEEDS_COLUMN not in text
    assert len(scores_csv(study).splitlines()) == 1 + 2 * 4 * 3


def test_scores_read_back_are_the_numbers_they_were(study):
    """Tables are made of differences of these: 9 digits of each left 5 of a small one."""
    third = replace(study.scores[0].score, value=1 / 3, floor=1.0)
    study = replace(study, scores=[replace(study.scores[0], score=third)])
    (row,) = csv.DictReader(io.StringIO(scores_csv(study)))
    assert float(row["value"]) == 1 / 3
    assert row["floor"] == "1"


def with_nets(study, has_converged=True):
    """The study with two nets, worse and better than retrieval (0.03), and retrieval itself."""
    names = ("occupancy", "r2n2", "retrieval")
    values = ([0.02] * 4, [0.05] * 4, [0.03] * 4)
    training_summaries = {
        name: TrainingSummary("cpu", 78, "family", has_converged) for name in names[:2]
    }
    training_summaries["retrieval"] = TrainingSummary("", 78, "family", True)
    return replace(
        study,
        methods={name: retrieval_named(name) for name in names},
        scores=[s for name, v in zip(names, values, strict=True) for s in scores(name, v)],
        parameters_and_steps=dict.fromkeys(names, (1_200_000, 4000)),
        training_summaries=training_summaries,
        input_views=dict.fromkeys(names, InputViews(12)) | {"occupancy": InputViews(1, 8)},
    )


def retrieval_named(name):
    return replace(load_method("retrieval"), name=name)


def test_a_net_no_better_than_retrieval_is_marked(study):
    rows = {
        row.method: row for row in table1_rows(with_nets(study), SETTINGS) if row.split == "test"
    }
    assert rows["r2n2"].undertrained == "no better than retrieval"
    assert rows["occupancy"].undertrained == ""
    assert rows["retrieval"].undertrained == ""


def test_a_net_that_was_still_learning_is_marked(study):
    rows = table1_rows(with_nets(study, has_converged=False), SETTINGS)
    reasons = {row.method: row.undertrained for row in rows}
    assert reasons["occupancy"] == "still learning"
    assert reasons["r2n2"] == "still learning, no better than retrieval"


def test_the_table_says_what_a_method_learned_from(study):
    rows = table1_rows(with_nets(study), SETTINGS)
    text = table1_md(rows, [Table1Extra(None, 1.5)] * len(rows), 0.9)
    assert "| 78 parts of other families; cpu, 1.2 M parameters, 4000 steps |" in text
    assert "| 78 parts of other families |" in text
    assert "**undertrained**: no better than retrieval" in text
    alone = [replace(row, num_train_parts=1) for row in rows if row.num_train_parts]
    assert "| 1 part of other families;" in table1_md(
        alone, [Table1Extra(None, 1.5)] * len(alone), 0.9
    )


def test_it_says_how_many_views_were_given_and_of_which_predictions_a_number_is(study):
    rows = table1_rows(with_nets(study), SETTINGS)
    views_and_predictions = {row.method: (row.views, row.num_predictions) for row in rows}
    assert views_and_predictions == {"occupancy": (1, 8), "r2n2": (12, 1), "retrieval": (12, 1)}
    text = table1_md(rows, [Table1Extra(None, 1.5)] * len(rows), 0.9)
    assert " | 1 (8 predictions) | test | " in text
    assert " | 12 | test | " in text
    (footnote,) = [
        line for line in text.splitlines() if "of the first prediction that has points" in line
    ]
    assert footnote.startswith("occupancy predicts 8 times, from one view each. ")
    assert "the figures and the viewer" in footnote


def test_predictions_without_a_point_are_counted(study):
    """Of a part that failed there is none to be counted."""
    rows = table1_rows(
        replace(with_nets(study), empty_predictions={("occupancy", "test"): 5}), SETTINGS
    )
    assert {row.method: row.empty_predictions for row in rows if row.empty_predictions} == {
        "occupancy": 5
    }
    with_failures = [replace(row, failures=1) for row in rows]
    text = table1_md(with_failures, [Table1Extra(None, 1.5)] * len(rows), 0.9)
    assert "has points. 5 of the 16 predictions over the test parts that did not fail have" in text


def test_of_one_family_it_says_that_there_is_no_interval(study):
    rows = table1_rows(study, SETTINGS)
    assert {(row.split, row.families) for row in rows} == {("test", 2), ("dev", 1)}
    extras = [Table1Extra(None, 1.5)] * len(rows)
    assert "there is no interval" in table1_md(rows, extras, 0.9)
    tested = [row for row in rows if row.split == "test"]
    assert "there is no interval" not in table1_md(tested, extras[: len(tested)], 0.9)
    texts = {row.split: format_row(row, extras[0])[COLUMNS.index("95 %")] for row in rows}
    assert texts["dev"] == ""
    assert " to " in texts["test"]
    csv_rows = list(csv.DictReader(io.StringIO(table1_csv(rows))))
    assert {row["ci_low"] + row["ci_high"] for row in csv_rows if row["split"] == "dev"} == {""}


def test_the_error_of_the_floors_stands_beside_them(study):
    """Of three test parts each 0.0003: 0.0003 / sqrt(3).  3 % of a floor is told; none is known."""
    with_errors = [replace(row, score=replace(row.score, floor_se=0.0003)) for row in study.scores]
    rows = table1_rows(replace(study, scores=with_errors), SETTINGS)
    text = format_row(rows[0], Table1Extra(None, 1.5))
    assert text[COLUMNS.index("floor, se")] == "0.00017"
    extras = [Table1Extra(None, 1.5)] * len(rows)
    assert "The floors of 3 test parts have a standard error above 1 %" in table1_md(
        rows, extras, 0.9
    )
    unknown = [replace(row, score=replace(row.score, floor_se=None)) for row in study.scores]
    (first, *_) = table1_rows(replace(study, scores=unknown), SETTINGS)
    assert (first.floor_se, first.imprecise_floors) == (None, 0)


def test_the_spread_over_seeds_stands_beside_the_test_parts_of_what_was_run(study):
    rows = table1_rows(replace(study, seeds_sd={"hull": 0.0123}), SETTINGS)
    shown_seeds = {
        (row.method, row.split): row.seeds_sd for row in rows if row.seeds_sd is not None
    }
    assert shown_seeds == {("hull", "test"): 0.0123}
    head, _, oracle, hull, *_, footnote = table1_md(
        rows, [Table1Extra(None, 1.5)] * 4, 0.9
    ).splitlines()
    at = head.split(" | ").index(SEEDS_COLUMN)
    assert (hull.split(" | ")[at], oracle.split(" | ")[at]) == ("0.01230", "")
    assert footnote.startswith(f"{SEEDS_COLUMN}: standard deviation")
