"""The tree of runs that a study and a sweep become."""

import pytest

from industnerf.tracking import study
from industnerf.tracking.report import Report
from industnerf.tracking.study import study_run
from industnerf.tracking.sweep import sweep_run
from tests.tracking.conftest import write_sweep


@pytest.fixture
def run(report, params):
    return study_run(Report(report, params))


@pytest.fixture
def methods(run):
    return {child.name: child for child in run.children}


def test_a_study_has_a_run_for_each_method(run, methods):
    assert (run.name, run.tags["kind"], run.tags["preset"]) == ("smoke", "study", "smoke")
    assert list(methods) == ["hull", "net"]
    assert {child.tags["kind"] for child in methods.values()} == {"method"}
    assert methods["net"].tags["scope"] == "dataset"
    assert methods["hull"].tags["inputs"] == "rgb"


def test_metrics_have_the_same_names_for_all_methods(methods):
    hull, net = (set(methods[name].metrics) for name in ("hull", "net"))
    assert net - hull == {"training_seconds", "training_peak_mb"}
    assert hull <= net
    assert {"emd", "emd_ratio", "chamfer", "seconds", "peak_mb", "emd_mm", "dev/emd"} <= hull
    assert methods["hull"].metrics["dev/emd"] == 0.5


def test_parameters_are_the_methods_own_and_those_that_all_share(run, methods):
    own = {"points": 2048, "grid_res": 32}
    shared = {"seed": 0, "views.count": 6, "views.radius": 4.1, "reconstruct.views": 0}
    assert methods["hull"].params == {"method": "hull", **own, **shared}
    assert methods["net"].params["train.epochs"] == 3  # it learns
    assert not [key for key in run.params if key.startswith("method.")]


def test_values_of_parts_are_curves_that_all_methods_share_the_steps_of(methods):
    assert methods["hull"].curves["part/emd"] == {0: 0.01, 1: 0.02, 2: 0.03}
    assert methods["net"].curves["part/emd"] == {0: 0.04, 1: 0.05, 2: 0.06}
    assert methods["net"].curves["part/seconds"] == {0: 3, 1: 4, 2: 5}
    table = methods["net"].table  # by whose rows one reads the steps
    assert list(table.part_id) == ["gear-a", "gear-b", "nut-a", "nut-b"]
    assert list(table.step) == [0, 1, 2, 3]


def test_of_very_many_parts_some_are_drawn(report, params, monkeypatch):
    monkeypatch.setattr(study, "MAX_CURVE_PARTS", 2)
    hull, _ = study_run(Report(report, params)).children
    assert hull.curves["part/emd"] == {0: 0.01, 2: 0.03}


def test_a_fold_has_its_training_and_the_parts_that_it_was_asked_about(methods):
    first, second = methods["net"].children
    assert (first.name, first.tags["kind"], first.tags["fold"]) == ("net fold-0", "fold", "fold-0")
    assert first.metrics["emd"] == pytest.approx(0.045)
    assert second.metrics["emd"] == 0.06  # nut-b is a dev part
    assert (first.metrics["training_seconds"], first.metrics["training_peak_mb"]) == (30, 500)
    assert second.curves["loss/training"] == {0: 0.75, 5: 0.25}
    assert second.curves["loss/validation"] == {4: 0.75}
    assert methods["net"].metrics["training_seconds"] == 61
    assert methods["hull"].children == []


def test_datasets_say_which_parts_are_scored_and_which_were_learned_from(methods):
    test, dev = methods["hull"].datasets
    assert (test.name, test.context, test.num_parts, test.num_families) == (
        "embedded",
        "test",
        3,
        2,
    )
    assert (dev.context, dev.num_parts) == ("dev", 1)
    first, second = methods["net"].children
    assert {one.context: one.num_parts for one in first.datasets} == {"training": 2, "test": 2}
    assert first.datasets[0].digest != second.datasets[0].digest
    assert methods["net"].datasets == methods["hull"].datasets


def test_published_results_need_no_data(root):
    study = root / "results" / "study"
    run = study_run(Report(study, {}))
    assert len(run.tags["commit"]) == 40
    assert len(list(run.children)) == len(list((study / "metrics").iterdir()))


def test_a_sweep_has_a_run_for_each_point_and_method_with_what_was_swept(tmp_path):
    run = sweep_run(write_sweep(tmp_path / "sweep"))
    assert (run.name, run.tags["kind"]) == ("smoke: views.count, method.hull.grid_res", "sweep")
    assert run.tags["swept"] == "views.count grid_res"
    points = {child.name: child for child in run.children}
    assert list(points) == [
        "hull views.count=4 grid_res=32",
        "net views.count=4",  # the hull's settings are not its own
        "hull views.count=8 grid_res=64",
        "net views.count=8",
    ]
    point = points["hull views.count=8 grid_res=64"]
    assert (point.params["views.count"], point.params["grid_res"]) == (8, 64)
    assert point.metrics["emd"] == pytest.approx(0.02 / 8)
    assert (point.tags["kind"], point.tags["point"]) == ("point", "views.count=8 x='my y'")
    assert "views.count" not in run.params
    assert run.params["views.radius"] == 4.1


def test_a_sweep_without_a_finished_point_is_no_run(tmp_path):
    (tmp_path / "multirun.yaml").touch()
    assert sweep_run(tmp_path) is None
