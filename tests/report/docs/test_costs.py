"""Costs by stage and method, and what they are on a cluster."""

import pytest

from industnerf.errors import BadArtifact
from industnerf.report.docs.costs import cluster_block, costs_block

COSTS = """\
stage,method,part_id,seconds,peak_mb,device,extra_seconds
views,,a,60,9,cpu,0
truth,,a,60,9,cpu,0
train,r2n2,fold-0,120,9,cpu,0
train,r2n2,fold-1,240,9,cpu,0
reconstruct,industnerf,a,30,9,cpu,6
reconstruct,industnerf,b,90,9,cpu,0
reconstruct,industnerf_plus,a,60,9,cpu,0
evaluate,hull,a,6,9,cpu,0
"""


def test_seconds_stand_by_stage_and_method(published):
    (published / "cost.csv").write_text(COSTS)
    text = costs_block(published)
    assert "| reconstruct | `industnerf` | 2 | 60.00 | 60.00 | 90.00 |" in text
    assert "| train | `r2n2` | 2 | 180.00 | 180.00 | 240.00 |" in text


def test_core_minutes_add_up_and_held_out_views_are_apart(published):
    (published / "cost.csv").write_text(COSTS)
    minutes = {"photographs": 1, "truth and floors": 1, "training": 6, "reconstruction": 3}
    minutes |= {"scoring": 0, "drawing held-out views": 0, "all": 11}
    text = costs_block(published)
    assert all(f"| {name} | {value} |\n" in text for name, value in minutes.items())
    assert "the report" not in text


def test_stages_of_the_parts_and_the_report_are_counted(published):
    more = "parts,,a,60,9,cpu,0\nsolids,,a,30,9,cpu,0\nreport,,,60,9,cpu,0\n"
    (published / "cost.csv").write_text(COSTS + more)
    text = costs_block(published)
    for row in ("cleaning meshes | 1", "the report | 1", "all | 14"):
        assert f"| {row} |\n" in text
    assert text.splitlines()[-3:] == [
        "| solids |  | 1 | 30.00 | 30.00 | 30.00 |",
        "| parts |  | 1 | 60.00 | 60.00 | 60.00 |",
        "| report |  | 1 | 60.00 | 60.00 | 60.00 |",
    ]


def test_a_cluster_takes_the_seconds_of_a_part_with_its_held_out_views(published):
    """Of one photographed part 120 s and 6 s for its views, so of 10 000 on 64 nodes 19 688 s."""
    (published / "cost.csv").write_text(COSTS)
    assert "| `industnerf` | 10 000 x 126.0 s / 64 | 5.5 h |" in cluster_block(published)


def test_costs_of_nothing_are_refused(published):
    (published / "cost.csv").write_text(COSTS.splitlines()[0] + "\n")
    with pytest.raises(BadArtifact, match=r"cost\.csv knows no cost"):
        cluster_block(published)
