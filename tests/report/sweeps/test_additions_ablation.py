"""What an addition earns, from points of a sweep whose scores are known."""

import pytest

from industnerf.errors import BadArtifact
from industnerf.report.sweeps.ablations import PointScores, ablation_table, describe_changes
from industnerf.schema import ReportParams

SETTINGS = ReportParams(bootstrap_resamples=200, confidence_level=0.95, contact_sheet_parts=1)
ALL_ON = {"relief.use": True, "levels[0].steps": 9, "levels[1].steps": 0, "levels[1].points": 5}
FAMILIES = {"a": "of-a", "b": "of-b"}


def outcome(settings, a, b, failed=0, rgb_mse=(), seconds=()):
    emd = {"a": a, "b": b}
    return PointScores(settings, emd, FAMILIES, failed, dict(rgb_mse), dict(seconds))


def rows(*points):
    lines = ablation_table(list(points), ALL_ON, SETTINGS).splitlines()[2:]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]


def test_the_worst_change_stands_first_after_none():
    table = rows(
        outcome(ALL_ON | {"relief.use": False}, 0.01, 0.04),
        outcome(
            ALL_ON, 0.02, 0.04, rgb_mse={"a": 0.001, "b": 0.002}, seconds={"a": 20.0, "b": 30.5}
        ),
        outcome(ALL_ON | {"levels[0].steps": 4}, 0.03, 0.07, failed=1, rgb_mse={"a": 0.004}),
    )
    assert table[0] == ["nothing", "0.0300", "", "", "", "0", "0.00150", "", "25.2"]
    # +0.01 and +0.03; of two families a bootstrap draws 0.01, 0.02 and 0.03, the ends often enough
    worst = ["`levels[0].steps: 4`", "0.0500", "+0.0200", "+0.0100 to +0.0300", "2 of 2", "1"]
    assert table[1] == [*worst, "0.00400", "1 of 1", ""]  # a failed part has no pictures
    assert table[2][2:] == ["-0.0050", "-0.0100 to +0.0000", "0 of 2", "0", "", "", ""]


def test_what_is_gone_is_named_once():
    without = {key: value for key, value in ALL_ON.items() if not key.startswith("levels[1]")}
    assert describe_changes(without, ALL_ON) == "no `levels[1]`"
    assert (
        describe_changes(without | {"relief.use": False}, ALL_ON)
        == "`relief.use: False`, no `levels[1]`"
    )
    assert describe_changes(ALL_ON, ALL_ON) == ""


def test_without_the_settings_of_today_there_is_nothing_to_compare_with():
    with pytest.raises(BadArtifact, match="were they changed after the sweep"):
        ablation_table([outcome(ALL_ON | {"relief.use": False}, 0.1, 0.2)], ALL_ON, SETTINGS)
