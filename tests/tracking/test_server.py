"""A study and a sweep as MLflow's server gives them out: what its pages are made of."""

import json
import os
import signal
import socket
import subprocess
import sys
import time
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.tracking.conftest import EMD, write_report, write_sweep

pytestmark = pytest.mark.slow  # starts a server
METHODS = "tags.kind = 'method'"


def log_folder(folder: Path) -> subprocess.CompletedProcess:
    """Log what is in `folder` as `make ui` does, into the database there."""
    environment = os.environ | {"INDUSTNERF_MLFLOW": str(folder), "MLFLOW_PORT": "5001"}
    command = [sys.executable, "-m", "industnerf.tracking"]
    return subprocess.run(
        command, cwd=folder, env=environment, check=True, capture_output=True, text=True
    )


class Server:
    """MLflow's server over the database in `folder`."""

    def __init__(self, folder: Path) -> None:
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.port = free.getsockname()[1]
        options = {"port": self.port, "backend-store-uri": f"sqlite:///{folder / 'mlflow.db'}"}
        self.process = subprocess.Popen(
            ["mlflow", "ui", "--workers=1", *(f"--{key}={one}" for key, one in options.items())],
            env=os.environ | {"MLFLOW_SERVER_ENABLE_JOB_EXECUTION": "false"},
            start_new_session=True,  # of several processes
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        deadline = time.monotonic() + 120
        while not self._is_up():
            assert self.process.poll() is None
            assert time.monotonic() < deadline
            time.sleep(0.5)
        self.experiment = self.get("experiments/get-by-name?experiment_name=industnerf")[
            "experiment"
        ]

    def _is_up(self) -> bool:
        try:
            with urllib.request.urlopen(f"http://127.0.0.1:{self.port}/health"):
                return True
        except OSError:
            return False

    def get(self, path: str, **body: Any) -> Any:
        """The response of the REST API, to a POST if there is a body."""
        request = urllib.request.Request(
            f"http://127.0.0.1:{self.port}/api/2.0/mlflow/{path}",
            json.dumps(body).encode() if body else None,
            {"Content-Type": "application/json"},
        )
        with urllib.request.urlopen(request) as response:
            return json.load(response)

    def search(self, text: str, *order: str) -> list[dict]:
        experiment = [self.experiment["experiment_id"]]
        response = self.get("runs/search", experiment_ids=experiment, filter=text, order_by=order)
        return response.get("runs", [])


@pytest.fixture(scope="module")
def server(tmp_path_factory) -> Iterator[Server]:
    folder = tmp_path_factory.mktemp("working-copy")
    write_report(folder)
    write_sweep(folder / "runs" / "sweeps" / "mine")
    log_folder(folder)
    server = Server(folder)
    yield server
    os.killpg(server.process.pid, signal.SIGTERM)
    server.process.wait()


def values(run: dict, kind: str) -> dict:
    """Metrics, params or tags of a run by name."""
    return {one["key"]: one["value"] for one in run["data"].get(kind, [])}


def test_methods_are_searched_by_the_value_of_a_metric_and_sorted(server):
    good = server.search(f"metrics.emd < 0.03 AND {METHODS}")
    assert [run["info"]["run_name"] for run in good] == ["hull"]
    ordered = server.search(METHODS, "metrics.emd DESC")
    assert [run["info"]["run_name"] for run in ordered] == ["net", "hull"]
    assert server.search("metrics.emd < 0.03 AND params.grid_res = '32' AND tags.scope = 'part'")


def test_a_study_is_above_its_methods_and_these_above_their_folds(server):
    (study,) = server.search("tags.kind = 'study'")
    children = server.search(f"tags.`mlflow.parentRunId` = '{study['info']['run_id']}'")
    assert sorted(run["info"]["run_name"] for run in children) == ["hull", "net"]
    (net,) = (run for run in children if run["info"]["run_name"] == "net")
    folds = server.search(f"tags.`mlflow.parentRunId` = '{net['info']['run_id']}'")
    assert sorted(run["info"]["run_name"] for run in folds) == ["net fold-0", "net fold-1"]
    assert {run["info"]["status"] for run in [study, *children, *folds]} == {"FINISHED"}


def test_any_two_methods_have_axes_in_common(server):
    """Which comparison, scatter and parallel coordinates draw, and rows are grouped by."""
    runs = server.search(METHODS)
    shared_metrics = set.intersection(*(set(values(run, "metrics")) for run in runs))
    assert {"emd", "emd_ratio", "chamfer", "seconds", "peak_mb", "failures"} <= shared_metrics
    assert {values(run, "params")["method"] for run in runs} == {"hull", "net"}
    for tag in ("preset", "scope", "inputs"):
        assert all(values(run, "tags")[tag] for run in runs)


def test_the_value_of_each_part_is_a_step_and_a_row_of_a_table(server):
    (run,) = server.search(f"{METHODS} AND params.method = 'net'")
    run_id = run["info"]["run_id"]
    history = server.get(f"metrics/get-history?run_id={run_id}&metric_key=part/emd")["metrics"]
    assert {one["step"]: one["value"] for one in history} == dict(enumerate(EMD["net"][:3]))
    files = server.get(f"artifacts/list?run_id={run_id}")["files"]
    assert "per_part.json" in [file["path"] for file in files]
    assert json.loads(values(run, "tags")["mlflow.loggedArtifacts"])[0]["type"] == "table"
    table = f"http://127.0.0.1:{server.port}/get-artifact?run_uuid={run_id}&path=per_part.json"
    with urllib.request.urlopen(table) as response:
        content = json.load(response)
    rows = [dict(zip(content["columns"], row, strict=True)) for row in content["data"]]
    assert {row["part_id"]: row["emd"] for row in rows}["gear-b"] == EMD["net"][1]


def test_datasets_are_inputs_of_runs(server):
    (run,) = server.search(f"{METHODS} AND params.method = 'net'")
    inputs = run["inputs"]["dataset_inputs"]
    contexts = {one["tags"][0]["value"]: one["dataset"] for one in inputs}
    assert set(contexts) == {"test", "dev"}
    assert contexts["test"]["name"] == "embedded"
    assert json.loads(contexts["test"]["profile"]) == {"parts": 3, "families": 2}


def test_a_sweep_is_above_its_points(server):
    (sweep,) = server.search("tags.kind = 'sweep'")
    points = server.search(f"tags.`mlflow.parentRunId` = '{sweep['info']['run_id']}'")
    assert len(points) == 4
    assert {values(run, "params")["views.count"] for run in points} == {"4", "8"}
    files = server.get(f"artifacts/list?run_id={sweep['info']['run_id']}")["files"]
    assert {"sweep.csv", "points"} <= {file["path"] for file in files}


def test_the_page_has_a_view_of_methods_and_one_of_the_sweep(server):
    tags = {tag["key"]: tag["value"] for tag in server.experiment["tags"]}
    prefix = "mlflow.sharedViewState."
    views = {key.removeprefix(prefix): tags[key] for key in tags if key.startswith(prefix)}
    states = {key: json.loads(json.loads(view)["state"]) for key, view in views.items()}
    methods = states.pop("methods")
    assert methods["selectedColumns"][:3] == [
        "metrics.`emd`",
        "metrics.`emd_ratio`",
        "metrics.`seconds`",
    ]
    order = f"{methods['orderByKey']} {'ASC' if methods['orderByAsc'] else 'DESC'}"
    runs = server.search(methods["searchFilter"], order)
    assert [run["info"]["run_name"] for run in runs] == ["hull", "net"]
    (points,) = states.values()
    assert len(server.search(points["searchFilter"])) == 4
    assert "params.`views.count`" in points["selectedColumns"]


def test_what_is_logged_is_not_logged_again_and_the_page_to_open_is_said(server, tmp_path):
    report = write_report(tmp_path)
    first = log_folder(tmp_path)
    address = "http://127.0.0.1:5001/#/experiments/1/runs?viewStateShareKey=methods"
    assert address in first.stderr
    assert first.stdout == f"sqlite:///{tmp_path / 'mlflow.db'}\n"
    before = (tmp_path / "mlruns").stat().st_mtime_ns
    (report / "report.html").write_text("of another minute")
    log_folder(tmp_path)
    assert (tmp_path / "mlruns").stat().st_mtime_ns == before  # a folder per run
