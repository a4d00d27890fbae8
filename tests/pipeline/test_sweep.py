"""Sweeps share the store with `dvc repro`, and end with a table and a plot."""

import csv

import pytest

from tests.pipeline.conftest import SMALL, Project

pytestmark = pytest.mark.slow  # runs whole pipelines


def run_sweep(project, *overrides):
    return project.run("python", "-m", "pipeline.sweep", "--multirun", *SMALL, *overrides)


def logged_runs(project):
    """Of every point that MLflow has the swept value, and whether its name says it."""
    script = (
        "import mlflow, sys; mlflow.set_tracking_uri(sys.argv[1]);"
        "runs = mlflow.search_runs(experiment_names=['industnerf'], output_format='list', "
        "filter_string=\"tags.kind = 'point'\");"
        "counts = [(run.data.params['views.count'], run.info.run_name) for run in runs];"
        "print(sorted((count, f'views.count={count}' in name) for count, name in counts))"
    )
    _, output = project.run(
        "python", "-c", script, f"sqlite:///{project.folder / 'mlflow' / 'mlflow.db'}"
    )
    return output.splitlines()[-1]


@pytest.fixture
def project(root, tmp_path, finished_run):
    """A project whose store is that of the finished run."""
    project = Project(root, tmp_path / "project")
    project.environment["INDUSTNERF_STORE"] = str(finished_run.folder / "store")
    return project


def test_a_sweep_reuses_what_dvc_made_logs_its_points_and_ends_with_a_plot(project):
    project.environment["INDUSTNERF_MLFLOW"] = str(project.folder / "mlflow")
    code, output = run_sweep(project, "views.count=6,4", "methods=[hull]")
    assert code == 0, output
    assert logged_runs(project) == "[('4', True), ('6', True)]"
    # the first point is the finished run: it makes nothing at all
    assert "views: done, 0 made, 2 reused, 0 failed" in output
    assert "views: done, 2 made, 0 reused, 0 failed" in output
    (folder,) = (project.folder / "runs" / "sweeps").iterdir()
    with (folder / "sweep.csv").open() as file:
        table = list(csv.DictReader(file))
    assert [row["views.count"] for row in table] == ["6", "4"]
    assert (folder / "sweep.png").stat().st_size > 1000
    assert "EMD over the sweep" in output


def test_a_failed_point_is_said_and_the_others_stand(project):
    code, output = run_sweep(project, "views.fov_deg=30.0,150.0", "methods=[oracle]")
    assert code != 0
    assert "views.fov_deg is 150.0, must be in (0, 120)" in output
    assert "Traceback" not in output
    (folder,) = (project.folder / "runs" / "sweeps").iterdir()
    assert len((folder / "sweep.csv").read_text().splitlines()) == 2


def test_an_unknown_key_ends_at_once(project):
    code, output = run_sweep(project, "views.cuont=3,4")
    assert code != 0
    assert "views.cuont" in output
    assert "Traceback" not in output


@pytest.mark.parametrize("choice", ["reading=frame-wrold", "ablation=photohull"])
def test_a_choice_that_has_no_file_is_refused(project, choice):
    """Hydra would go on without it, and the point bear a name that it does not deserve."""
    code, output = run_sweep(project, choice, "methods=[ball]")
    assert code != 0
    assert f"{choice} is unknown, " in output
    assert "known are" in output
    assert not list(project.folder.glob("runs/sweeps/*/0/reports"))


def test_a_folder_of_something_else_stays_as_it_is(project):
    folder = project.folder / "mine"
    folder.mkdir()
    for name in ("table1.csv", "made.json", "sweep.csv"):
        (folder / name).write_text("dear")
    code, output = run_sweep(project, "methods=[ball]", "hydra.sweep.dir=mine")
    assert (code, "mine holds something else than a sweep" in output) == (2, True)
    assert [path.read_text() for path in sorted(folder.iterdir())] == ["dear"] * 3


def test_a_sweep_into_the_folder_of_an_earlier_one_replaces_it_alone(project):
    overrides = ("methods=[ball]", "hydra.sweep.dir=mine")
    assert run_sweep(project, "seed=1,2", *overrides)[0] == 0
    (project.folder / "mine" / "notes.csv").write_text("dear")
    (project.folder / "mine" / "7").mkdir()  # a point that failed before its params.yaml
    assert run_sweep(project, "seed=1", *overrides)[0] == 0
    names = {path.name for path in (project.folder / "mine").iterdir()}
    assert {"0", "notes.csv"} <= names
    assert names.isdisjoint({"1", "7"})
