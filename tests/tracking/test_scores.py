"""What MLflow is given of scores and costs: the same names for all methods, as in Table 1."""

import json

import pandas as pd
import pytest

from industnerf.tracking.scores import (
    mean_scores,
    metric_name,
    part_table,
    read_costs,
    read_part_scores,
)


def rows_of(report, method, split="test"):
    scores = read_part_scores(report)
    return scores[(scores.method == method) & (scores.split == split)]


@pytest.mark.parametrize(
    ("metric", "protocol", "name"),
    [
        ("emd", "P1-even", "emd"),
        ("emd", "P1-iid", "emd_iid"),
        ("chamfer", "P1-dense", "chamfer"),
        ("psnr", "P1-union", "psnr"),
        ("psnr", "P1-frame", "psnr_frame"),
    ],
)
def test_the_reading_that_tables_name_first_has_the_plain_name(metric, protocol, name):
    assert metric_name(metric, protocol) == name


def test_means_are_of_processor_seconds_and_the_ratio_that_of_the_means(report):
    means = mean_scores(rows_of(report, "hull"))
    assert means["emd"] == pytest.approx(0.02)
    assert means["emd_ratio"] == pytest.approx(4)
    assert (means["seconds"], means["peak_mb"]) == (3, 60)
    assert means["emd_iid"] == pytest.approx(0.04)
    assert means["chamfer"] == pytest.approx(0.2)
    assert (means["failures"], means["parts"], means["families"]) == (0, 3, 2)
    assert next(iter(means)) == "emd"  # the axis that MLflow's comparison begins with


def test_costs_without_processor_time_are_by_the_clock(report):
    costs = pd.read_csv(report / "cost.csv").drop(columns="cpu_seconds")
    costs.to_csv(report / "cost.csv")
    assert mean_scores(rows_of(report, "hull"))["seconds"] == 99


def test_a_part_that_failed_is_counted(report):
    scores = pd.read_csv(report / "scores.csv")
    scores.loc[0, "status"] = "failed"
    scores.to_csv(report / "scores.csv")
    assert mean_scores(rows_of(report, "hull"))["failures"] == 1


def test_the_table_has_a_row_a_part_and_is_json_that_browsers_read(report):
    costs = read_costs(report, "reconstruct")
    costs[costs.part_id != "gear-a"].to_csv(report / "cost.csv")
    rows = part_table(rows_of(report, "net")).to_dict("records")
    assert [row["part_id"] for row in rows] == ["gear-a", "gear-b", "nut-a"]
    assert [row["step"] for row in rows] == [0, 1, 2]
    assert list(rows[0])[:2] == ["part_id", "emd"]  # what MLflow groups by, and compares
    assert (rows[0]["seconds"], rows[1]["seconds"]) == (None, 4)
    json.dumps(rows, allow_nan=False)


def test_the_published_study_has_the_values_of_its_table(root):
    """Of every method, test parts and dev parts; the table has six digits."""
    study = root / "results" / "study"
    table, scores = pd.read_csv(study / "table1.csv"), read_part_scores(study)
    assert len(table) > 20
    for row in table.itertuples():
        own = mean_scores(scores[(scores.method == row.method) & (scores.split == row.split)])
        assert own["emd"] == row.emd_even
        assert own["emd_ratio"] == pytest.approx(row.ratio_to_floor, rel=1e-5)
        assert own["emd_iid"] == pytest.approx(row.emd_iid, rel=1e-5)
        assert own["failures"] == row.failures
