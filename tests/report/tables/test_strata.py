"""Means over kinds of parts."""

import csv
import io
from dataclasses import replace

import pytest

from industnerf.report.html.tables import strata_table
from industnerf.report.tables.strata import strata_csv, strata_md, stratum_rows
from tests.samples import unit_part
from tests.studies import SETTINGS, make_study

KINDS = [("pockets",), ("aged", "pockets"), (), ("thin",)]
PARTS = [
    unit_part(name, family, strata=kinds)
    for name, family, kinds in zip("abcd", "fghi", KINDS, strict=True)
]


@pytest.fixture
def study():
    """Three test parts, two with pockets; the hull failed on one.  The only thin one is for dev."""
    emds = {"hull": [0.02, float("inf"), 0.03, 0.0], "nerf": [0.02, 0.04, 0.06, 0.0]}
    return make_study(PARTS, emds, dev="d")


def test_a_row_a_stratum_and_method_all_first_and_the_best_leads(study):
    rows = stratum_rows(study, SETTINGS)
    assert [(row.stratum, row.method) for row in rows] == [
        (stratum, method) for stratum in ("all", "aged", "pockets") for method in ("nerf", "hull")
    ]


def test_a_mean_is_over_the_test_parts_of_the_stratum(study):
    rows = {(row.stratum, row.method): row for row in stratum_rows(study, SETTINGS)}
    nerf, hull = rows["pockets", "nerf"], rows["pockets", "hull"]
    assert nerf.emd_even == pytest.approx(0.03)
    assert nerf.ratio_to_floor == pytest.approx(3)
    assert (nerf.ci_low, nerf.ci_high) == pytest.approx((0.02, 0.04))
    assert (nerf.parts, nerf.families, nerf.failures) == (2, 2, 0)
    assert (hull.emd_even, hull.failures) == (pytest.approx(0.51), 1)
    assert (rows["all", "nerf"].emd_even, rows["all", "nerf"].parts) == (pytest.approx(0.04), 3)


def test_a_stratum_that_a_method_has_no_score_of_stays_empty(study):
    """Scoring failed, not the method: that would be a score too."""
    torn = [s for s in study.scores if (s.part_id, s.method) != ("b", "hull")]
    rows = stratum_rows(replace(study, scores=torn), SETTINGS)
    hull = next(line for line in strata_md(rows).splitlines() if line.startswith("| hull"))
    assert hull.split(" | ")[2] == ""
    assert any(row.cells[0] == "hull" for row in strata_table(rows).rows)


def test_the_files_hold_what_the_rows_do(study):
    rows = stratum_rows(study, SETTINGS)
    read = list(csv.DictReader(io.StringIO(strata_csv(rows))))
    assert [row["method"] for row in read] == [row.method for row in rows]
    assert (read[0]["emd_even"], read[0]["parts"]) == ("0.04", "3")
    assert strata_md(rows).splitlines() == [
        "| EMD (even) | all (3) | aged (1) | pockets (2) |",
        "| --- | --- | --- | --- |",
        "| nerf | 0.0400, 0.0693 mm, 4.00 x floor | 0.0400, 0.0693 mm, 4.00 x floor "
        "| 0.0300, 0.0520 mm, 3.00 x floor |",
        "| hull | 0.3500, 0.606 mm, 35.00 x floor | 1.0000, 1.73 mm, 100.00 x floor "
        "| 0.5100, 0.883 mm, 51.00 x floor |",
    ]
