"""Several runs at once on one store, and a store of ten thousand results."""

import subprocess
import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest

from industnerf.doctor import run_check
from industnerf.doctor.project_paths import ProjectPaths
from industnerf.stage import Task, read_index, run_stage
from tests.pipeline.conftest import SMALL, Project

pytestmark = pytest.mark.campaign
ENTRIES = 10_000


def test_two_runs_and_a_sweep_at_once_agree(
    root: Path, tmp_path: Path, print_row: Callable[[str], None]
):
    alone = Project(root, tmp_path / "alone")
    assert alone.run()[0] == 0
    store = str(tmp_path / "store")
    projects = [Project(root, tmp_path / f"run-{number}") for number in (1, 2)]
    for project in projects:
        project.environment["INDUSTNERF_STORE"] = store
    sweep_dir = tmp_path / "sweep"
    sweep_command = [sys.executable, "-m", "pipeline.sweep", "--multirun", *SMALL]
    sweep_command += ["seed=0,1", f"hydra.sweep.dir={sweep_dir}"]
    start = time.monotonic()
    processes = [project.start("dvc", "repro") for project in projects]
    sweep = subprocess.run(
        sweep_command, cwd=root, env=projects[0].environment, capture_output=True, text=True
    )
    ended = [(process.communicate()[0], process.returncode) for process in processes]
    assert [code for _, code in ended] == [0, 0], ended
    assert sweep.returncode == 0, sweep.stdout + sweep.stderr
    expected = alone.outputs()
    for project in projects:
        outputs = project.outputs()
        assert [name for name in expected if outputs.get(name) != expected[name]] == []
    point = sweep_dir / "0/data"
    swept = {
        f"data/{path.relative_to(point)}": path.read_bytes()
        for path in point.rglob("*")
        if path.is_file()
    }
    differing = [name for name in swept if expected.get(name) != swept[name]]
    assert differing == []
    paths = ProjectPaths(tmp_path / "none", Path(store), tmp_path / "mlflow.db")
    assert run_check("store", paths) == []
    print_row(
        f"two runs and a sweep at once: {time.monotonic() - start:.0f} s, {len(expected)} files"
    )


def write_number(target: Path, *, number: int) -> None:
    (target / "number").write_text(str(number))


def test_ten_thousand_results(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, print_row: Callable[[str], None]
):
    monkeypatch.setenv("INDUSTNERF_STORE", str(tmp_path / "store"))
    monkeypatch.setenv("INDUSTNERF_RUNNER", "serial")
    tasks = [Task(f"p{n}", partial(write_number, number=n), n, ()) for n in range(ENTRIES)]
    seconds = []
    for _ in range(2):
        start = time.monotonic()
        run_stage("numbers", tasks, tmp_path / "out", "strict")
        seconds.append(time.monotonic() - start)
    assert len(read_index(tmp_path / "out")) == ENTRIES
    damaged = next((tmp_path / "store/numbers").glob("*/out/number"))
    damaged.unlink()
    start = time.monotonic()
    paths = ProjectPaths(tmp_path, tmp_path / "store", tmp_path / "mlflow.db")
    (finding,) = run_check("store", paths)
    doctor_seconds = time.monotonic() - start
    assert finding.path == damaged.parent.parent
    run_stage("numbers", tasks, tmp_path / "out", "strict")
    assert damaged.exists()
    print_row(
        f"{ENTRIES} results: {seconds[0]:.0f} s made, {seconds[1]:.0f} s reused, "
        f"{doctor_seconds:.0f} s to examine"
    )
