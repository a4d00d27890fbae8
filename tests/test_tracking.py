"""MLflow: one run per distinct result, safe under concurrency, never fatal."""

import fcntl
import json
import subprocess
import sys

import numpy as np
import pytest

from industnerf import tracking
from industnerf.artifacts.history import History
from industnerf.tracking import git_state, log_report

LOG = """
import sys
from pathlib import Path
from industnerf.tracking import log_report
log_report(Path(sys.argv[1]), {"views": {"count": 6}, "seed": 0})
"""
BACKFILL = """
import sys
from pathlib import Path
from industnerf.tracking import backfill
backfill(Path(sys.argv[1]))
"""
BROKEN_ONCE = """
import sys
from pathlib import Path
from industnerf import tracking
rightly, tracking._log_methods = tracking._log_methods, None
tracking.log_report(Path(sys.argv[1]), {"seed": 0})
tracking._log_methods = rightly
"""
LOG_POINT = """
import sys
from pathlib import Path
from industnerf.tracking import backfill, log_report, save_tags
report = Path(sys.argv[1])
save_tags(report, point="views.count=6 parts.path='my parts'")
log_report(report, {"views": {"count": 6}})
backfill(report.parent)
"""
READ = """
import sys, mlflow
mlflow.set_tracking_uri(f"sqlite:///{sys.argv[1]}/mlflow.db")
only = "attributes.status = 'FINISHED'"
(run,) = mlflow.search_runs(
    experiment_names=["industnerf"], filter_string=only, output_format="list"
)
print(run.info.run_name)
files = mlflow.MlflowClient().list_artifacts(run.info.run_id, "report")
print(run.data.params, run.data.metrics, sorted(run.data.tags), [f.path for f in files])
curve = mlflow.MlflowClient().get_metric_history(run.info.run_id, "net.loss")
print([(point.step, point.value) for point in curve])
curve = mlflow.MlflowClient().get_metric_history(run.info.run_id, "net.fit.validation")
print([point.value for point in curve])
print(sorted(f.path for f in mlflow.MlflowClient().list_artifacts(run.info.run_id)))
print(mlflow.artifacts.load_dict(f"{run.info.artifact_uri}/per_part.json"))
"""


@pytest.fixture
def report(tmp_path, monkeypatch):
    folder = tmp_path / "reports"
    folder.mkdir()
    summary = {"schema": 1, "results": "abc", "preset": "smoke", "metrics": {"hull.test.emd": 0.1}}
    (folder / "summary.json").write_text(json.dumps(summary))
    (folder / "scores.csv").write_text(
        "part_id,family,method,split,metric,protocol,value,status\n"
        "p1,gears,net,test,emd,P1-even,0.1,ok\n"
    )
    (folder / "cost.csv").write_text(
        "stage,method,part_id,seconds,peak_mb,device,extra_seconds\nreconstruct,net,p1,3,70,cpu,0\n"
    )
    cloud = tmp_path / "data" / "clouds" / "net" / "p1"
    cloud.mkdir(parents=True)
    History(np.array([0, 5]), np.array([0.5, 0.25]), {"level 0": 0}).save(cloud)
    validation = tmp_path / "data" / "states" / "net" / "fold-0" / "validation"
    validation.mkdir(parents=True)
    History(np.array([4]), np.array([0.75]), {}).save(validation)
    (folder / "report.html").write_text("<html>")
    monkeypatch.setenv("INDUSTNERF_MLFLOW", str(tmp_path / "mlflow"))
    return folder


def start(script, *arguments):
    return subprocess.Popen(
        [sys.executable, "-c", script, *map(str, arguments)],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )


def finish(process):
    output, _ = process.communicate()
    return process.returncode, output


@pytest.mark.slow
def test_two_at_once_on_a_fresh_database_log_one_run(report, tmp_path):
    """Without the lock MLflow's migrations collide and leave a database that never opens again."""
    for process in [start(LOG, report) for _ in range(2)]:
        assert finish(process)[0] == 0
    code, output = finish(start(READ, tmp_path / "mlflow"))
    assert code == 0, output
    assert "{'views.count': '6', 'seed': '0'} {'hull.test.emd': 0.1, 'net." in output
    assert "'net.seconds': 3.0" in output
    assert "'net.peak_mb': 70.0" in output
    assert "[(0, 0.5), (5, 0.25)]" in output
    assert "[0.75]" in output
    assert "['per_part.json', 'report']" in output
    assert "[['p1', 'gears', 'test', 'net', 0.1, 'ok', 3, 70]]" in output
    assert "git.commit" not in output  # nobody noted at which it was made
    assert "'results'" in output
    assert "report/report.html" in output


@pytest.mark.slow
def test_a_method_that_was_dropped_is_not_in_the_run(report, tmp_path):
    """DVC leaves its clouds where they are; of parts without views they cannot even be shown."""
    dropped = tmp_path / "data" / "clouds" / "gone" / "p1"
    dropped.mkdir(parents=True)
    History(np.array([0]), np.array([9.0]), {}).save(dropped)
    script = LOG.replace('"seed": 0', '"seed": 0, "methods": ["net"]')
    assert finish(start(script, report))[0] == 0
    code, output = finish(start(READ, tmp_path / "mlflow"))
    assert code == 0, output
    assert "net.loss" in output
    assert "gone.loss" not in output


@pytest.mark.slow
def test_what_was_logged_by_half_is_logged_anew(report, tmp_path):
    code, output = finish(start(BROKEN_ONCE + LOG, report))
    assert code == 0
    assert "MLflow: not logged (TypeError" in output
    code, output = finish(start(READ, tmp_path / "mlflow"))
    assert code == 0, output
    assert "[(0, 0.5), (5, 0.25)]" in output


@pytest.mark.slow
def test_a_point_of_a_sweep_is_not_logged_a_second_time_as_a_study(report, tmp_path):
    assert finish(start(LOG_POINT, report))[0] == 0
    code, output = finish(start(READ, tmp_path / "mlflow"))
    assert code == 0, output
    assert output.startswith("views.count=6 parts.path='my parts'\n")
    assert "'git.commit', 'git.dirty', 'mlflow." in output


def test_a_broken_database_is_said_and_not_fatal(report, tmp_path):
    (tmp_path / "mlflow").mkdir()
    (tmp_path / "mlflow" / "mlflow.db").write_text("no database")
    code, output = finish(start(LOG, report))
    assert code == 0
    assert "MLflow: not logged" in output
    assert "The result is safe in" in output


def test_a_lock_that_a_stopped_process_holds_is_not_waited_for_for_ever(
    report, tmp_path, monkeypatch, capsys
):
    """Its result is safe, and the run must come to its end."""
    monkeypatch.setenv("INDUSTNERF_MLFLOW", str(tmp_path))
    monkeypatch.setattr(tracking, "LOCK_PATIENCE_S", 0.3)
    with (tmp_path / "mlflow.db.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        log_report(report, {"seed": 0})
    assert "mlflow.db.lock is held for more than 0.3 s" in capsys.readouterr().err


def test_tracking_can_be_switched_off(report, tmp_path, monkeypatch):
    monkeypatch.setenv("INDUSTNERF_MLFLOW", "off")
    log_report(report, {})
    assert not (tmp_path / "mlflow").exists()


def test_settings_that_cannot_be_read_keep_no_other_report_from_being_logged(report, tmp_path):
    broken = tmp_path / "runs" / "mine" / "reports"
    broken.mkdir(parents=True)
    (broken / "summary.json").write_text((report / "summary.json").read_text())
    (broken.parent / "params.yaml").write_text("seed: [")
    code, output = finish(start(BACKFILL, tmp_path))
    assert code == 0, output
    assert f"MLflow: {broken} is not logged: " in output
    code, output = finish(start(READ, tmp_path / "mlflow"))
    assert output.startswith("smoke\n")


def test_what_results_are_written_to_makes_no_tree_dirty(tmp_path, monkeypatch):
    """As in made.json: dvc.lock is written by the very run that is logged."""
    monkeypatch.chdir(tmp_path)
    for name in ("code.py", "dvc.lock"):
        (tmp_path / name).write_text("as committed\n")
    identity = ("-c", "user.name=n", "-c", "user.email=e@example.org")
    for command in (("init", "-q"), ("add", "-A"), (*identity, "commit", "-q", "-m", "first")):
        subprocess.run(["git", *command], check=True)
    (tmp_path / "dvc.lock").write_text("changed\n")
    assert git_state()["git.dirty"] == "false"
    (tmp_path / "code.py").write_text("changed\n")
    assert git_state()["git.dirty"] == "true"


def test_outside_a_repository_there_is_no_commit(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert git_state() == {}
