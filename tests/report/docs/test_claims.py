"""Each claim's verdict follows from the published number, and only from it."""

import csv
import io

import pytest

from industnerf.report.docs.claim import FAILS, HOLDS, UNDECIDED, verdict_of
from industnerf.report.docs.claims import claims_block
from industnerf.report.tables.goals import AUSE_SHARE
from industnerf.report.tables.scores import SPEARMAN

TABLE1 = ["method", "split", "inputs", "num_train_parts", "undertrained", "emd_even"]
TABLE1 += ["ratio_to_floor", "views"]
COMPARISONS = ["method", "other", "difference", "ci_low", "ci_high", "win_rate", "families"]
SCORES = ["part_id", "method", "family", "split", "metric", "protocol", "value"]
GOALS = ["method", "goal", "value"]
COSTS = ["stage", "method", "part_id", "seconds"]
PARAMS = """
seed: 0
report: {bootstrap_resamples: 500, confidence_level: 0.95, contact_sheet_parts: 1}
"""


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
            ("industnerf", "r2n2", -0.06, -0.07, -0.05, 1.0, 16),
            ("industnerf", "atlasnet", -0.01, -0.03, 0.01, 0.6, 16),
            ("industnerf", "carve", 0.005, 0.002, 0.007, 0.2, 16),
        ],
    )
    emds = {("industnerf", "gears"): 0.01, ("industnerf", "pipes"): 0.03}
    emds |= {("r2n2", "gears"): 0.08, ("r2n2", "pipes"): 0.08}
    emds |= {("atlasnet", "gears"): 0.04, ("atlasnet", "pipes"): 0.02}
    scores = [("p", *key, "test", "emd", "P1-even", value) for key, value in emds.items()]
    write_csv(folder / "scores.csv", SCORES, scores)
    write_csv(folder / "cost.csv", COSTS, [])
    write_csv(folder / "goals.csv", GOALS, [])
    (folder / "params.yaml").write_text(PARAMS)
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


def test_a_family_in_which_one_baseline_is_better_refutes_every_category(study, tmp_path):
    rows = rows_of(claims_block(study, tmp_path))
    verdict, measured = rows["better than the baselines in every category of objects"]
    assert verdict == FAILS
    assert measured == "better than 3D-R2N2, AtlasNet in 1 of 2 families"
    verdict, measured = rows["consistent quality across categories of objects"]
    assert verdict == UNDECIDED
    assert "0.0100 to 0.0300" in measured


@pytest.mark.parametrize(("seconds", "verdict"), [(0.4, HOLDS), (1.5, FAILS), (9.0, FAILS)])
def test_faster_than_the_baselines_is_faster_than_each(study, tmp_path, seconds, verdict):
    rows = [("industnerf", seconds), ("r2n2", 0.5), ("atlasnet", 2.0)]
    costs = [("reconstruct", method, "p", value) for method, value in rows]
    write_csv(study / "cost.csv", COSTS, costs)
    found, measured = rows_of(claims_block(study, tmp_path))["faster than the baselines"]
    assert found == verdict
    assert "3D-R2N2 0.5, AtlasNet 2.0 when trained" in measured


@pytest.mark.parametrize(("families", "verdict"), [(3, UNDECIDED), (5, UNDECIDED), (6, HOLDS)])
def test_generalization_takes_six_families_of_organic_shapes(study, tmp_path, families, verdict):
    rows = [("industnerf", "r2n2", -0.05, -0.06, -0.04, 0.9, families)]
    rows += [("industnerf", "atlasnet", -0.06, -0.07, -0.05, 1.0, families)]
    write_csv(study.with_name("organic") / "comparisons.csv", COMPARISONS, rows)
    write_csv(study.with_name("organic") / "table1.csv", TABLE1, [])
    assert rows_of(claims_block(study, tmp_path))["generalizes better than the baselines"] == (
        verdict,
        "EMD on the organic set less that of 3D-R2N2 -0.0500, AtlasNet -0.0600; better than each "
        f"on 90 % of the parts or more; {families} families",
    )


@pytest.mark.parametrize(
    ("second", "share", "verdict"),
    [(-0.6, 0.4, HOLDS), (-0.4, 0.4, UNDECIDED), (-0.6, 1.1, UNDECIDED)],
)
def test_confidences_count_where_they_sort_by_error(study, tmp_path, second, share, verdict):
    write_csv(study / "goals.csv", GOALS, [("industnerf", AUSE_SHARE, share)])
    values = {("p", "gears"): -0.7, ("q", "pipes"): second}
    scores = [(p, "industnerf", f, "test", *SPEARMAN, v) for (p, f), v in values.items()]
    scores.append(("p", "nerf", "gears", "test", *SPEARMAN, -0.9))
    write_csv(study / "scores.csv", SCORES, scores)
    found, measured = rows_of(claims_block(study, tmp_path))["confidences can be interpreted"]
    # The mean of two families lies below -0.5 each time; drawn twice, the second alone decides.
    good = 1 + (second <= -0.5)
    assert found == verdict
    assert measured == (
        f"rank correlation with the error {(second - 0.7) / 2:.2f} (-0.70 to {second:.2f}), -0.5 "
        f"or lower on {good} of 2 parts; AUSE is {share:.2f} of that of a random order"
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
        ] == (
            verdict,
            "EMD: 4 to 8 views -0.0100 (-0.0200 to -0.0050), "
            f"8 to 16 views -0.0040 (-0.0100 to {second:+.4f})",
        )


@pytest.mark.parametrize(("exponent", "verdict"), [(1.5, HOLDS), (0.1, FAILS), (1.1, UNDECIDED)])
def test_cost_grows_faster_than_linearly_or_not(study, tmp_path, exponent, verdict):
    columns = ["series", "quantity", "exponent", "standard error", "points"]
    trend = tmp_path / "sweep-complexity" / "trend.csv"
    write_csv(trend, columns, [("industnerf", "seconds", exponent, 0.1, 5)])
    claim = "cost may grow faster than linearly with complexity"
    assert rows_of(claims_block(study, tmp_path))[claim][0] == verdict


def test_noise_is_shown_on_too_few_parts_to_be_judged(study, tmp_path):
    sweep = tmp_path / "sweep-noise-nerf" / "sweep.csv"
    columns = ["views.sensor.noise", "method", "emd"]
    write_csv(sweep, columns, [(0, "industnerf", 0.026), (0.05, "industnerf", 0.03)])
    assert rows_of(claims_block(study, tmp_path))["sensitive to noise in the images"] == (
        UNDECIDED,
        "EMD 0.0260 without, 0.0300 with a standard deviation of 0.05; four dev parts are too few "
        "for a test",
    )


def test_of_one_family_nothing_has_an_interval_and_nothing_is_told(study, tmp_path):
    rows = [("industnerf", "r2n2", -0.06, "", "", 1.0, 1)]
    write_csv(study / "comparisons.csv", COMPARISONS, rows)
    assert rows_of(claims_block(study, tmp_path))["better than 3D-R2N2"] == (
        UNDECIDED,
        "EMD -0.0600, better on 100 % of the parts; it answers from 5 views; "
        "it is undertrained here",
    )
