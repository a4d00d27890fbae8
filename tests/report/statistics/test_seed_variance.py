"""What a sweep over the seed says of each method."""

import csv
import io
from statistics import fmean

import pytest

from industnerf.errors import BadArtifact
from industnerf.report.part_subsets import SEED_PARTS, order_by_hash
from industnerf.report.statistics.seed_variance import (
    add_mean_mm,
    emds_with_seed_0,
    read_seed_variances,
    seed_variance,
    seed_variances,
    seeds_csv,
    seeds_md,
)
from industnerf.report.tables.scores import scores_csv
from tests.samples import unit_part
from tests.studies import make_study

EMDS = {0: {"a": 1.0, "b": 5.0}, 1: {"a": 2.0, "b": 6.0}, 2: {"a": 3.0, "b": 4.0}}


def test_means_and_standard_deviations_by_hand():
    variances = seed_variance("hull", EMDS)
    assert variances.means == {0: 3.0, 1: 4.0, 2: 3.5}
    assert (variances.parts, variances.mean) == (2, 3.5)
    assert variances.sd == pytest.approx(0.5)
    # both parts have three values that are 1 apart: variance 1
    assert variances.part_sd == pytest.approx(1.0)


def test_one_seed_or_other_parts_are_refused():
    with pytest.raises(BadArtifact, match=r"hull: a spread needs two seeds or more, found \[0\]"):
        seed_variance("hull", {0: EMDS[0]})
    with pytest.raises(BadArtifact, match="hull: seed 1 has not the same parts: b"):
        seed_variance("hull", EMDS | {1: {"a": 2.0}})


def write_sweep(folder, names, methods, dev=()):
    """Two points; with seed 1 every EMD is 0.02 more.  A part's EMD is as it is called."""
    for seed in (0, 1):
        values = [0.01 * int(name.removeprefix("part-")) + 0.02 * seed for name in names]
        emds = dict.fromkeys(methods, values)
        study = make_study([unit_part(name) for name in names], emds, dev=dev, seed=seed)
        path = folder / str(seed) / "reports" / "scores.csv"
        path.parent.mkdir(parents=True)
        path.write_text(scores_csv(study))
    return folder


def test_sweeps_over_few_parts_and_over_all_are_read_on_the_same_ones(tmp_path):
    everything = [f"part-{i}" for i in range(40)]
    dev = order_by_hash("seeds", everything)[:3]  # would be the first, were they test parts
    fixed = order_by_hash("seeds", set(everything) - set(dev))[:SEED_PARTS]
    few = write_sweep(tmp_path / "few", fixed, ["hull"])
    many = write_sweep(tmp_path / "many", everything, ["r2n2"], dev)
    variances = seed_variances([few, many])
    assert {row.method for row in variances} == {"hull", "r2n2"}
    assert {row.parts for row in variances} == {SEED_PARTS}
    mean = fmean(0.01 * int(name.removeprefix("part-")) for name in fixed)
    for row in variances:
        assert row.means == pytest.approx({0: mean, 1: mean + 0.02})
    assert [row.sd for row in variances] == pytest.approx([0.02 / 2**0.5] * 2)


def test_a_folder_without_a_finished_point_is_refused(tmp_path):
    with pytest.raises(BadArtifact, match="no finished point of a sweep"):
        seed_variances([tmp_path])


def test_the_files_hold_what_the_rows_do():
    rows = [seed_variance("hull", EMDS), seed_variance("ball", {0: EMDS[0], 5: EMDS[1]})]
    hull, ball = csv.DictReader(io.StringIO(seeds_csv(rows)))
    assert list(hull.values()) == ["hull", "2", "3", "4", "3.5", "", "3.5", "0.5", "1", ""]
    assert (ball["seed_5"], ball["seed_1"], ball["mean"]) == ("4", "", "3.5")
    assert seeds_md(rows).splitlines()[2] == (
        "| hull | 2 | 3.00000 | 4.00000 | 3.50000 |  | 3.50000 | 0.50000 | 1.00000 |  |"
    )


def test_the_file_is_read_back(tmp_path):
    rows = [seed_variance("hull", EMDS), seed_variance("ball", {0: EMDS[0], 5: EMDS[1]})]
    assert read_seed_variances(tmp_path) == []
    (tmp_path / "seeds.csv").write_text(seeds_csv(rows))
    assert seeds_csv(read_seed_variances(tmp_path)) == seeds_csv(rows)


def test_mm_are_of_the_seed_that_was_measured_and_of_nothing_else():
    """Seed 0 has 1.0 and 5.0 of diagonals of 10 and 2 mm; the ball's scores are of another run."""
    rows = [seed_variance("hull", EMDS), seed_variance("ball", EMDS), seed_variance("box", EMDS)]
    known = {"hull": EMDS[0], "ball": EMDS[1]}
    hull, ball, box = add_mean_mm(rows, known, {"a": 10.0, "b": 2.0})
    assert hull.mean_mm == pytest.approx((10 + 10) / 2)
    assert (ball.mean_mm, box.mean_mm) == (None, None)


def test_the_first_seed_of_a_sweep_is_found(tmp_path):
    folder = write_sweep(tmp_path / "few", ["part-1", "part-2"], ["hull"])
    variances = emds_with_seed_0(sorted(folder.glob("*/reports")))
    assert variances["hull"] == pytest.approx({"part-1": 0.01, "part-2": 0.02})
