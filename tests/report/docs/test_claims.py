"""Each claim's verdict follows from the published number, and only from it."""

import csv
import io

import pytest

from industnerf.report.docs.claims import FAILS, HOLDS, UNDECIDED, claims_block, verdict_of
from industnerf.report.tables.goals import AUSE_SHARE, CONFIDENCE_CORRELATION
from industnerf.report.tables.scores import SPEARMAN

TABLE1 = ["method", "split", "inputs", "num_train_parts", "undertrained", "emd_even"]
TABLE1 += ["ratio_to_floor", "views"]
COMPARISONS = ["method", "other", "difference", "ci_low", "ci_high", "win_rate"]
SCORES = ["part_id", "method", "family", "split", "metric", "protocol", "value"]
GOALS = ["method", "goal", "value"]


def write_csv(path, columns, rows):
    path.parent.mkdir(parents=True, exist_ok=True)
    text = io.StringIO()
    csv.writer(text).writerows([columns, *rows])
    path.write_text(text.getvalue())


@pytest.fixture
def study(tmp_path):
    folder = tmp_path / "study"
    rows = [
        ("industnerf", "test", "rgb", 0, "", 0.02, 2.5, 40),
        ("r2n2", "test", "rgb", 66, "no better than retrieval", 0.08, 9.0, 5),
        ("atlasnet", "test", "rgb", 66, "", 0.03, 4.0, 1),
        ("carve", "test", "rgb", 0, "", 0.015, 1.9, 40),
    ]
    write_csv(folder / "table1.csv", TABLE1, rows)
    write_csv(
        folder / "comparisons.csv",
        COMPARISONS,
        [
            ("industnerf", "r2n2", -0.06, -0.07, -0.05, 1.0),
            ("industnerf", "atlasnet", -0.01, -0.03, 0.01, 0.6),
            ("industnerf", "carve", 0.005, 0.002, 0.007, 0.2),
        ],
    )
    emds = {("industnerf", "gears"): 0.01, ("industnerf", "pipes"): 0.03}
    emds |= {("r2n2", "gears"): 0.08, ("r2n2", "pipes"): 0.08}
    emds |= {("atlasnet", "gears"): 0.04, ("atlasnet", "pipes"): 0.02}
    scores = [("p", *key, "test", "emd", "P1-even", value) for key, value in emds.items()]
    write_csv(folder / "scores.csv", SCORES, scores)
    write_csv(folder / "cost.csv", ["stage", "method", "part_id", "seconds"], [])
    write_csv(folder / "goals.csv", GOALS, [])
    return folder


def rows_of(block):
    """Claim -> verdict and measurement."""
    cells = [line.strip("| ").split(" | ") for line in block.splitlines() if "**" in line]
    return {cell[-3]: (cell[-2].strip("*"), cell[-1]) for cell in cells}


@pytest.mark.parametrize(
    ("low", "high", "verdict"),
    [
        (-2.0, -1.0, HOLDS),
        (1.0, 2.0, FAILS),
        (-1.0, 1.0, UNDECIDED),
        (0.0, 0.0, UNDECIDED),
        (None, None, UNDECIDED),
    ],
)
def test_an_interval_decides(low, high, verdict):
    assert verdict_of(low, high) == verdict


def test_claims_against_other_methods(study, tmp_path):
    rows = rows_of(claims_block(study, tmp_path))
    assert rows["better than 3D-R2N2"][0] == HOLDS
    assert rows["better than 3D-R2N2"][1].endswith("it is undertrained here")
    assert rows["better than AtlasNet"] == (
        UNDECIDED,
        "EMD -0.0100 (-0.0300 to +0.0100), better on 60 % of the parts; it answers from one view",
    )
    assert rows["better than space carving"][0] == FAILS
    assert "better than Occupancy Networks" not in rows  # it did not run


def test_a_family_in_which_one_baseline_is_better_refutes_consistency(study, tmp_path):
    verdict, measured = rows_of(claims_block(study, tmp_path))[
        "better than the baselines in every category of objects"
    ]
    assert verdict == FAILS
    assert "better than 3D-R2N2, AtlasNet in 1 of 2 families" in measured
    assert "0.0100 to 0.0300" in measured


@pytest.mark.parametrize(
    ("correlation", "share", "verdict"),
    [(-0.6, 0.4, HOLDS), (-0.4, 0.4, UNDECIDED), (-0.6, 1.1, UNDECIDED)],
)
def test_confidences_count_where_they_sort_by_error(study, tmp_path, correlation, share, verdict):
    goals = [("industnerf", CONFIDENCE_CORRELATION, correlation), ("industnerf", AUSE_SHARE, share)]
    write_csv(study / "goals.csv", GOALS, goals)
    values = {("p", "industnerf"): -0.7, ("q", "industnerf"): -0.4, ("p", "nerf"): -0.9}
    scores = [(*key, "gears", "test", *SPEARMAN, value) for key, value in values.items()]
    write_csv(study / "scores.csv", SCORES, scores)
    assert rows_of(claims_block(study, tmp_path))["confidences can be interpreted"] == (
        verdict,
        f"rank correlation with the error {correlation:.2f}, -0.5 or lower on 1 of 2 parts; "
        f"AUSE is {share:.2f} of that of a random order",
    )


def test_more_views_hold_only_if_every_step_does(study, tmp_path):
    columns = ["series", "from", "to", "EMD changes by", "ci_low", "ci_high"]
    steps = tmp_path / "sweeps" / "sweep-views" / "steps.csv"
    for second, verdict in ((-0.001, HOLDS), (0.002, UNDECIDED)):
        rows = [("industnerf", 4, 8, -0.01, -0.02, -0.005), ("industnerf", 8, 16, -0.004, -0.01)]
        rows[1] += (second,)
        write_csv(steps, columns, [*rows, ("hull", 4, 8, 0.5, 0.4, 0.6)])
        assert rows_of(claims_block(study, tmp_path / "sweeps"))[
            "more input views, more precision (up to 16 views)"
        ] == (verdict, "EMD: 4 to 8 views -0.0100, 8 to 16 views -0.0040")


@pytest.mark.parametrize(("exponent", "verdict"), [(1.5, HOLDS), (0.1, FAILS), (1.1, UNDECIDED)])
def test_cost_grows_faster_than_linearly_or_not(study, tmp_path, exponent, verdict):
    columns = ["series", "quantity", "exponent", "standard error", "points"]
    trend = tmp_path / "sweep-complexity" / "trend.csv"
    write_csv(trend, columns, [("industnerf", "seconds", exponent, 0.1, 5)])
    claim = "cost may grow faster than linearly with complexity"
    assert rows_of(claims_block(study, tmp_path))[claim][0] == verdict


@pytest.mark.parametrize(("noisy", "verdict"), [(0.0265, UNDECIDED), (0.03, HOLDS), (0.02, FAILS)])
def test_noise_counts_where_four_parts_can_tell(study, tmp_path, noisy, verdict):
    sweep = tmp_path / "sweep-noise-nerf" / "sweep.csv"
    columns = ["views.sensor.noise", "method", "emd"]
    write_csv(sweep, columns, [(0, "industnerf", 0.026), (0.05, "industnerf", noisy)])
    claim = "sensitive to noise in the images"
    assert rows_of(claims_block(study, tmp_path))[claim][0] == verdict


def test_of_one_family_nothing_has_an_interval_and_nothing_is_told(study, tmp_path):
    rows = [("industnerf", "r2n2", -0.06, "", "", 1.0)]
    write_csv(study / "comparisons.csv", COMPARISONS, rows)
    assert rows_of(claims_block(study, tmp_path))["better than 3D-R2N2"] == (
        UNDECIDED,
        "EMD -0.0600, better on 100 % of the parts; it answers from 5 views; "
        "it is undertrained here",
    )
