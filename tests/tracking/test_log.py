"""Logging: once per distinct result, safe under concurrency, never fatal, never by half."""

import fcntl
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from industnerf.tracking import database, log_report, log_sweep
from industnerf.tracking.tags import git_state, load_tags, save_tags
from tests.tracking.conftest import write_report, write_sweep

LOG = """
import sys
from pathlib import Path
from industnerf.config import read_yaml
from industnerf.tracking import log_report
report = Path(sys.argv[1])
log_report(report, read_yaml(report.parent / "params.yaml"))
"""
KILLED = """
import os
from industnerf.tracking import write
def kill(client, run_id, run):
    if run.name == "net":
        os._exit(9)
write._write_files = kill
"""
LOG_SWEEP = """
import sys
from pathlib import Path
from industnerf.tracking import log_sweep
log_sweep(Path(sys.argv[1]))
"""
BACKFILL = """
import sys
from pathlib import Path
from industnerf.tracking import backfill
backfill(Path(sys.argv[1]))
"""
RUNS = """
import sys, mlflow
client = mlflow.MlflowClient(f"sqlite:///{sys.argv[1]}/mlflow.db")
for experiment in client.search_experiments():
    for run in client.search_runs([experiment.experiment_id]):
        kind = run.data.tags.get("kind")
        print(experiment.name, kind, run.info.run_name, run.info.status, sep="|")
"""
OLDER = """
import sys, mlflow
mlflow.set_tracking_uri(f"sqlite:///{sys.argv[1]}/mlflow.db")
mlflow.set_experiment("industnerf")
with mlflow.start_run(run_name="demo"):
    mlflow.log_metric("hull.test.emd_even", 0.02)
"""


@pytest.fixture
def mlflow(tmp_path, monkeypatch) -> Path:
    """The folder of the database."""
    folder = tmp_path / "mlflow"
    monkeypatch.setenv("INDUSTNERF_MLFLOW", str(folder))
    return folder


def start(script, *arguments) -> subprocess.Popen:
    return subprocess.Popen(
        [sys.executable, "-c", script, *map(str, arguments)],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )


def run(script, *arguments, code=0) -> str:
    process = start(script, *arguments)
    output, _ = process.communicate()
    assert process.returncode == code, output
    return output


def runs(folder: Path) -> list[str]:
    """`experiment|kind|name|status` of every run that is not deleted."""
    return sorted(run(RUNS, folder).splitlines())


STUDY = [
    "industnerf|fold|net fold-0|FINISHED",
    "industnerf|fold|net fold-1|FINISHED",
    "industnerf|method|hull|FINISHED",
    "industnerf|method|net|FINISHED",
    "industnerf|study|smoke|FINISHED",
]


@pytest.mark.slow
def test_two_at_once_on_a_fresh_database_log_one_study(report, mlflow):
    """Without the lock MLflow's migrations collide and leave a database that never opens again."""
    for process in [start(LOG, report) for _ in range(2)]:
        output, _ = process.communicate()
        assert (process.returncode, output) == (0, "")
    assert runs(mlflow) == STUDY


@pytest.mark.slow
def test_what_was_logged_by_half_is_logged_anew_and_the_half_removed(report, mlflow):
    run(KILLED + LOG, report, code=9)
    assert "industnerf|method|net|RUNNING" in runs(mlflow)
    run(LOG, report)
    assert runs(mlflow) == STUDY


@pytest.mark.slow
def test_earlier_runs_of_a_study_each_stay_beside_and_their_artifacts_can_be_logged(report, mlflow):
    mlflow.mkdir()
    run(OLDER, mlflow)
    shutil.copytree(report, mlflow / "mlruns" / "0a1b" / "artifacts" / "report")
    output = run(BACKFILL, mlflow / "mlruns")
    assert "stay in the experiment 'industnerf (one run per study)'" in output
    older = ["industnerf (one run per study)|None|demo|FINISHED"]
    assert runs(mlflow) == older + STUDY
    assert run(LOG, report) == ""
    assert runs(mlflow) == older + STUDY


@pytest.mark.slow
def test_a_sweep_takes_the_place_of_what_was_logged_of_its_first_points(tmp_path, mlflow):
    """As when the page is opened while it runs; the same folder with other results is another."""
    sweep = write_sweep(tmp_path / "sweep", (4,))
    run(LOG_SWEEP, sweep)
    run(LOG_SWEEP, write_sweep(sweep, (4, 8)))
    logged = runs(mlflow)
    assert len([one for one in logged if "|sweep|" in one]) == 1
    assert len([one for one in logged if "|point|" in one]) == 4
    (sweep / "1" / "reports" / "scores.csv").unlink()
    (sweep / "0" / "reports" / "label.json").unlink()
    run(LOG_SWEEP, sweep)
    assert len([one for one in runs(mlflow) if "|sweep|" in one]) == 2


def test_a_point_is_logged_with_its_sweep_alone(tmp_path, mlflow, monkeypatch):
    sweep = write_sweep(tmp_path / "sweep", (4,))
    monkeypatch.chdir(sweep / "0")
    log_report(Path("reports"), {})
    assert not mlflow.exists()


def test_a_broken_database_is_said_and_not_fatal(report, mlflow):
    mlflow.mkdir()
    (mlflow / "mlflow.db").write_text("no database")
    output = run(LOG, report)
    assert "MLflow: not logged" in output
    assert f"The result is safe in {report}" in output


def test_a_lock_that_a_stopped_process_holds_is_not_waited_for_for_ever(
    report, mlflow, monkeypatch, capsys
):
    """Its result is safe, and the run must come to its end."""
    mlflow.mkdir()
    monkeypatch.setattr(database, "LOCK_PATIENCE_S", 0.3)
    with (mlflow / "mlflow.db.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        log_report(report, {"seed": 0})
    assert "mlflow.db.lock is held for more than 0.3 s" in capsys.readouterr().err


def test_tracking_can_be_switched_off(report, tmp_path, monkeypatch):
    monkeypatch.setenv("INDUSTNERF_MLFLOW", "off")
    monkeypatch.chdir(tmp_path)
    log_report(report, {})
    log_sweep(tmp_path)
    assert set(os.listdir()) == {"study"}


@pytest.mark.slow
def test_settings_that_cannot_be_read_keep_no_other_report_from_being_logged(tmp_path, mlflow):
    write_report(tmp_path / "runs" / "demo")
    broken = write_report(tmp_path / "runs" / "broken")
    (broken.parent / "params.yaml").write_text("seed: [")
    output = run(BACKFILL, tmp_path)
    assert "MLflow: not logged (BadParams: " in output
    assert f"safe in {broken}" in output
    assert runs(mlflow) == STUDY


def test_what_results_are_written_to_makes_no_tree_dirty(tmp_path, monkeypatch):
    """As in made.json: dvc.lock is written by the very run that is logged."""
    monkeypatch.chdir(tmp_path)
    for name in ("code.py", "dvc.lock"):
        (tmp_path / name).write_text("as committed\n")
    identity = ("-c", "user.name=n", "-c", "user.email=e@example.org")
    for command in (("init", "-q"), ("add", "-A"), (*identity, "commit", "-q", "-m", "first")):
        subprocess.run(["git", *command], check=True)
    (tmp_path / "dvc.lock").write_text("changed\n")
    assert git_state()["dirty"] == "false"
    (tmp_path / "code.py").write_text("changed\n")
    save_tags(tmp_path, point="seed=1")
    tags = load_tags(tmp_path)
    assert (len(tags.pop("commit")), tags) == (40, {"dirty": "true", "point": "seed=1"})


def test_outside_a_repository_there_is_no_commit(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert git_state() == {}
