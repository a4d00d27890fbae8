"""What a published study is said to have found, from tables that are given."""

import pytest

from industnerf.report.docs.findings import describe_findings
from industnerf.report.tables.formats import csv_text

DIFFERENCE_COLUMNS = ("difference", "ci_low", "ci_high", "difference_mm")
COMPARISONS = ("method", "other", *DIFFERENCE_COLUMNS, "p_holm", "win_rate")
GOALS = ("method", "goal", "target", "value", "met", "tsdf", "oracle")
TABLE1 = ("method", "split", "undertrained")
INSPECTION = ("method", "covered_0.5mm", "covered_1mm")


@pytest.fixture
def study(tmp_path):
    """Writes the tables, which are empty unless they are given."""

    def write(comparisons=(), goals=(), table1=(), inspection=()):
        for name, columns, rows in (
            ("comparisons", COMPARISONS, comparisons),
            ("goals", GOALS, goals),
            ("table1", TABLE1, table1),
            ("inspection", INSPECTION, inspection),
        ):
            (tmp_path / f"{name}.csv").write_text(csv_text(columns, rows))
        return describe_findings(tmp_path, "90 %")

    return write


def test_who_is_better_by_how_much_and_how_sure_that_is(study):
    text = study(
        comparisons=[
            ("industnerf", "hull", 0.0012, -0.001, 0.003, -0.004, 0.2, 0.25),
            ("industnerf_plus", "hull", -0.0123, -0.02, -0.01, -1.234, 0.004, 0.75),
            ("industnerf", "nerf", -0.1, -0.2, -0.1, -9.0, 0.001, 1.0),
        ]
    )
    better, worse = text.splitlines()
    assert better == (
        "- `industnerf_plus` has an EMD 0.0123 lower than `hull` (90 %: -0.0200 to -0.0100; "
        "in mm -1.23; p 0.004 after Holm's correction), and is better on 75 % of the parts."
    )
    assert "0.0012 higher than `hull` (90 %: -0.0010 to +0.0030; in mm -0.00; p 0.2" in worse
    assert "after Holm's correction: not certain)" in worse


def test_nets_that_are_weaker_than_they_should_be_are_named_with_the_reason(study):
    weak = "no better than retrieval"
    rows = [("r2n2", "test", weak), ("r2n2", "dev", "other"), ("occupancy", "test", "")]
    assert study(table1=rows) == f"- Nets that are weaker than they should be: `r2n2` ({weak}).\n"


def test_the_surface_covered_is_in_per_cent_where_it_was_measured(study):
    rows = [("oracle", 0.77, 0.94), ("hull", 0.531, 0.709), ("industnerf", "", ""), ("box", 0, "")]
    assert "cloud: `hull` 53 and 71 %, `oracle` 77 and 94 %." in study(inspection=rows)


def test_goals_that_are_missed_stand_in_a_table_beside_the_bounds(study):
    met = ("industnerf", "seconds", "at most 30", 19.9, "yes", "", "")
    missed = ("industnerf", "EMD", "at most 0.02", 0.0222, "no", 0.0102, 0.009)
    text = study(goals=[met, missed])
    assert text.startswith("1 of 2 goals are missed ([all of them](results/")
    assert "| `industnerf` | EMD | at most 0.02 | 0.0222 | 0.0102 | 0.00900 |\n" in text
    assert "seconds" not in text
    assert study(goals=[met]).endswith(".\n")
    assert "0 of 1 goals are missed" in study(goals=[met])


def test_a_study_without_any_of_it_says_nothing(study):
    assert study() == ""
