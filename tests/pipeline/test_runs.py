"""The pipeline as a user meets it: finished, interrupted, killed, and given bad input."""

import csv
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest
import trimesh

from industnerf.artifacts.views import load_views
from industnerf.stage import read_failures, read_index
from tests.pipeline.conftest import Project

pytestmark = pytest.mark.slow  # runs whole pipelines

REPORT_FILES = {
    "comparisons.csv",
    "comparisons.md",
    "contact_sheet.png",
    "cost.csv",
    "cost.md",
    "goals.csv",
    "goals.md",
    "inspection.csv",
    "inspection.md",
    "label.json",
    "metrics",
    "origins.md",
    "pareto.png",
    "plots",
    "report.html",
    "scores.csv",
    "strata.csv",
    "strata.md",
    "strata.png",
    "summary.json",
    "table1.csv",
    "table1.md",
    "table2.csv",
    "table2.md",
}
TABLE1 = (
    "method,scope,inputs,split,preset,views,emd_even,ci_low,ci_high,floor,ratio_to_floor,emd_iid,"
    "emd_full,parts,failures,parameters,steps,paper_emd,"
    "size,num_train_parts,hold_out,undertrained,emd_mm,num_predictions,seeds_sd,empty_predictions,families,"
    "floor_se,imprecise_floors"
)
SCORES = (
    "part_id,family,method,scope,split,preset,seed,metric,protocol,value,floor,floor_se,unit,status"
)
TABLE2 = "method,subset,loss,value,ci_low,ci_high,unit,paper,coverage"
COMPARISONS = (
    "method,other,difference,ci_low,ci_high,difference_mm,p,p_holm,win_rate,parts,families"
)
STRATA = (
    "stratum,method,emd_even,ci_low,ci_high,emd_mm,floor,ratio_to_floor,parts,families,failures"
)
INSPECTION = (
    "method,emd_mm,emd_median_mm,hausdorff95_mm,hausdorff95_median_mm,"
    "within_0.1mm,within_0.5mm,within_1mm,covered_0.1mm,covered_0.5mm,covered_1mm,parts"
)
GOALS = "method,goal,target,value,met,supplement,unit,coverage,tsdf,oracle"
COST = "stage,method,part_id,seconds,peak_mb,device,extra_seconds,cpu_seconds,extra_cpu_seconds"


def rows(path):
    with path.open() as file:
        return list(csv.DictReader(file))


def test_a_run_ends_with_the_report(finished_run):
    reports = finished_run.folder / "reports"
    assert {path.name for path in reports.iterdir()} == REPORT_FILES
    headers = {
        name: (reports / name).read_text().splitlines()[0] for name in REPORT_FILES if "csv" in name
    }
    assert {path.stem for path in (reports / "metrics").iterdir()} == {
        "hull",
        "mean_shape",
        "oracle",
    }
    assert {path.name for path in (reports / "plots").iterdir()} == {
        "curves.csv",
        "emd.csv",
        "pareto.csv",
    }
    assert headers == {
        "table1.csv": TABLE1,
        "table2.csv": TABLE2,
        "comparisons.csv": COMPARISONS,
        "strata.csv": STRATA,
        "inspection.csv": INSPECTION,
        "goals.csv": GOALS,
        "scores.csv": SCORES,
        "cost.csv": COST,
    }
    assert "is left out" in (reports / "table2.md").read_text()
    page = (reports / "report.html").read_text()
    assert "http" not in page.replace("http-equiv", "")  # nothing is fetched: it opens offline
    for folder in (finished_run.folder / "data" / "views").glob("*/"):
        visible_share = load_views(folder).train_visible_share
        assert 0.5 < visible_share < 1  # of a clevis and an enclosure, from six sides
        assert f"<td>{100 * visible_share:.0f} %" in page


def test_every_part_metric_and_protocol_has_a_score_and_a_cost(finished_run):
    scores = rows(finished_run.folder / "reports" / "scores.csv")
    metrics = {(row["metric"], row["protocol"]) for row in scores}
    # EMD in three protocols; Chamfer, F-score, Hausdorff-95 and twice three tolerances in one
    assert len(metrics) == 3 + 3 + 2 * 3
    assert len(scores) == 2 * 3 * len(metrics)  # parts x methods x kinds
    assert {row["status"] for row in scores} == {"ok"}
    costs = rows(finished_run.folder / "reports" / "cost.csv")
    # parts, views, truth; reconstruct, evaluate per method; two folds of the one that learns; the
    # report itself
    assert len(costs) == 2 * 3 + 2 * 3 * 2 + 2 + 1
    assert costs[-1]["stage"] == "report"
    assert all(float(row["seconds"]) > 0 and float(row["peak_mb"]) > 0 for row in costs)


def test_the_oracle_is_at_the_floor_and_no_method_beats_it(finished_run):
    table = {row["method"]: row for row in rows(finished_run.folder / "reports" / "table1.csv")}
    # floor and oracle are the same protocol between independent samples of one surface; over two
    # parts and 128 points they agree to some per cent
    assert float(table["oracle"]["ratio_to_floor"]) == pytest.approx(1, abs=0.15)
    assert float(table["hull"]["emd_even"]) > float(table["oracle"]["emd_even"])


def test_nothing_to_do_reruns_nothing(finished_run):
    code, output = finished_run.run()
    assert code == 0
    assert "Data and pipelines are up to date." in output


def test_what_python_compiles_is_no_change_of_the_code(finished_run, root):
    stray = root / "src" / "industnerf" / "artifacts" / "__pycache__" / "stray.pyc"
    stray.parent.mkdir(exist_ok=True)
    stray.touch()
    try:
        code, output = finished_run.run("dvc", "status")
    finally:
        stray.unlink()
    assert code == 0
    assert "Data and pipelines are up to date." in output


def test_a_run_killed_in_every_stage_ends_with_equal_bytes(finished_run, root, tmp_path):
    project, before = Project(root, tmp_path / "project"), {}
    for step in ("parts", "views", "truth", "train", "reconstruct", "evaluate"):
        code, _ = project.stop_at(step, signal.SIGKILL)
        assert code == -signal.SIGKILL
        assert before.items() <= project.finished().items()  # finished parts are not redone
        before = project.finished()
    code, output = project.run()
    assert code == 0, output
    assert before.items() <= project.finished().items()
    assert project.outputs() == finished_run.outputs()


def test_ctrl_c_says_that_finished_parts_are_kept(root, tmp_path):
    project = Project(root, tmp_path / "project")
    code, output = project.stop_at("views", signal.SIGINT)
    assert code != 0
    assert "finished parts are kept" in output
    assert "Traceback" not in output


@pytest.fixture
def own_files(tmp_path):
    """A folder with two solids and two files that are none."""
    folder = tmp_path / "cad"
    folder.mkdir()
    trimesh.creation.annulus(5, 10, 8).export(folder / "ring.stl")
    trimesh.creation.box((10, 20, 5)).export(folder / "block.ply")
    (folder / "text.stl").write_text("no mesh")
    (folder / "empty.obj").write_text("")
    return folder


def test_own_files_replace_the_catalogue_and_broken_ones_are_listed(own_files, root, tmp_path):
    project = Project(root, tmp_path / "project")
    project.set(parts={"source": "path", "path": str(own_files), "select": []}, methods=["hull"])
    code, output = project.run()
    assert code == 0, output
    assert "text failed: text.stl: " in output
    assert "empty failed: empty.obj: " in output
    table = rows(project.folder / "reports" / "table1.csv")
    assert [(row["split"], row["parts"]) for row in table] == [("test", "2")]
    assert "empty.obj" in (project.folder / "reports" / "report.html").read_text()


def test_strict_ends_with_the_broken_files_named(own_files, root, tmp_path):
    project = Project(root, tmp_path / "project")
    project.set(
        on_failure="strict",
        parts={"source": "path", "path": str(own_files), "select": []},
        methods=["hull"],
    )
    code, output = project.run()
    assert code != 0
    assert "error: stage solids: 2 of 4 parts failed, the rest are stored. Failed:" in output
    assert "Traceback" not in output
    assert len(project.finished()) == 2


def test_a_cloud_that_cannot_be_scored_is_a_loss_and_no_failure_of_the_method(
    finished_run, tmp_path
):
    """Neither left out, which would be a mean over other parts, nor scored as a failure.

    A torn file stands for whatever a score cannot be had of.
    """
    data, clouds, out = finished_run.folder / "data", tmp_path / "clouds", tmp_path / "scores"
    shutil.copytree(data / "clouds", clouds)
    torn, *others = sorted(path.name for path in (clouds / "hull").iterdir() if path.is_dir())
    for file in (clouds / "hull" / torn).glob("*.npz"):
        file.unlink()
        file.write_bytes(b"torn")
    folders = [
        str(folder) for folder in (data / "parts", data / "views", data / "truth", clouds, out)
    ]
    command = [sys.executable, "-m", "pipeline.stages.evaluate", *folders]
    environment = finished_run.environment | {"INDUSTNERF_STORE": str(tmp_path / "store")}
    ended = subprocess.run(
        command, cwd=finished_run.folder, env=environment, capture_output=True, text=True
    )
    assert ended.returncode == 1
    assert "1 were lost by the machine, the cluster or a metric" in ended.stderr
    assert list(read_failures(out / "hull")) == [torn]
    assert list(read_index(out / "hull")) == others
    assert not (out / "hull" / "scores.csv").exists()
    assert (out / "oracle" / "scores.csv").exists()  # of what comes behind it


@pytest.fixture(scope="module")
def spare_project(finished_run, tmp_path_factory):
    """A project with the finished run's store, to be spoilt and mended."""
    project = Project(Path(__file__).parents[2], tmp_path_factory.mktemp("spare") / "project")
    project.environment["INDUSTNERF_STORE"] = str(finished_run.folder / "store")
    return project


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"views": {"count": "many"}}, "views.count is 'many', must be a whole number"),
        ({"views": {"cuont": 3}}, "views.cuont is unknown"),
        ({"parts": {"select": ["gaer"]}}, "parts.select: 'gaer' is not among"),
        ({"views": {"radius": 1.5}}, "views.radius"),
    ],
)
def test_bad_parameters_end_with_one_message(spare_project, changes, message):
    before = spare_project.set(**changes)
    code, output = spare_project.run()
    spare_project.set(**before)
    assert code != 0
    assert message in output
    assert "Traceback" not in output


def test_with_nothing_left_to_learn_from_a_method_fails_and_the_others_stand(root, tmp_path):
    """One part, and its own family is held out: there is no other."""
    overrides = ["parts.select=[clevis-din71752-g12x24]", "methods=[hull,mean_shape]"]
    project = Project(root, tmp_path / "project", *overrides)
    code, output = project.run()
    assert code == 0, output
    assert "no part is left to learn from" in output
    assert "split.hold_out" in output
    table = {r["method"]: r["failures"] for r in rows(project.folder / "reports" / "table1.csv")}
    assert table == {"hull": "0", "mean_shape": "1"}


def test_with_nothing_held_out_one_part_learns_from_itself(root, tmp_path):
    overrides = ["parts.select=[clevis-din71752-g12x24]", "methods=[mean_shape]"]
    project = Project(root, tmp_path / "project", *overrides, "split.hold_out=none")
    code, output = project.run()
    assert code == 0, output
    (row,) = rows(project.folder / "reports" / "table1.csv")
    assert (row["num_train_parts"], row["hold_out"]) == ("1", "none")
