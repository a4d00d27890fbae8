"""Means and medians in mm."""

import csv
import io

import pytest

from industnerf.artifacts.scores import PartScore, Score
from industnerf.report.tables.inspection import inspection_csv, inspection_md, inspection_rows
from tests.samples import unit_part
from tests.studies import make_study

EDGES = (3.0, 4.0, 12.0)  # mm: a box of these has a diagonal of 13
PARTS = [
    unit_part("a", "f", extents_mm=EDGES),
    unit_part("b", "g", extents_mm=tuple(10 * edge for edge in EDGES)),
    unit_part("c", "h", extents_mm=EDGES),
    unit_part("d", "i", extents_mm=EDGES),
]


@pytest.fixture
def study():
    """Three test parts, the second ten times as large; what is within 1 mm is known of two."""
    with_distances = make_study(PARTS, {"box": [0.2] * 4, "hull": [0.01, 0.02, 0.03, 9.0]}, dev="d")
    for part, share, hausdorff in (("a", 1.0, 0.1), ("b", 0.5, 0.8), ("d", 0.0, 99.0)):
        for metric, value, unit in (
            ("within_1mm", share, "share"),
            ("covered_1mm", share / 2, "share"),
            ("hausdorff95", hausdorff, "mm"),
        ):
            score = Score(metric, "P1-dense", value, 0.0, unit, "ok")
            with_distances.scores.append(PartScore(part, "hull", score))
    return with_distances


def test_a_distance_is_brought_to_mm_part_by_part(study):
    hull, box = inspection_rows(study)
    assert (hull.method, box.method) == ("hull", "box")
    assert hull.emd_mm == pytest.approx((0.13 + 2.6 + 0.39) / 3)
    assert hull.emd_median_mm == pytest.approx(0.39)
    assert hull.hausdorff95_mm == pytest.approx(0.45)
    assert hull.within == {"1mm": pytest.approx(0.75)}
    assert hull.covered == {"1mm": pytest.approx(0.375)}
    assert hull.parts == 3


def test_what_was_not_measured_is_left_empty(study):
    table_rows = inspection_rows(study)
    assert table_rows[1].hausdorff95_mm is None
    rows = list(csv.DictReader(io.StringIO(inspection_csv(table_rows))))
    assert (rows[0]["within_1mm"], rows[0]["covered_1mm"]) == ("0.75", "0.375")
    assert rows[1]["within_1mm"] == rows[1]["covered_1mm"] == rows[1]["hausdorff95_mm"] == ""
    head, _, first, second = inspection_md(table_rows).splitlines()
    assert "| cloud within 1 mm | surface within 1 mm |" in head
    assert "| 75.0 % | 37.5 % | 3 |" in first
    assert second.endswith("|  |  |  |  | 3 |")
