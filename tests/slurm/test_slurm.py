"""The runner against a real SLURM of one node, which the tests start and end themselves."""

import os
import re
import shutil
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import partial

import pytest
from hydra import compose, initialize_config_dir
from omegaconf import OmegaConf

from industnerf.config import build
from industnerf.errors import BadParams
from industnerf.runner import runner_from_environment
from industnerf.schema import Params
from industnerf.stage import Task, run_stage
from pipeline.in_process import run_pipeline
from tests.pipeline.conftest import TIMING_FILES
from tests.slurm import work_items
from tests.slurm.cluster import Cluster, unavailable_reason

pytestmark = pytest.mark.slurm

STAGE = """
import sys; from functools import partial; from pathlib import Path
from industnerf.runner import runner_from_environment; from tests.slurm import work_items
list(runner_from_environment().map([partial(work_items.hang, Path(sys.argv[1]))], 60.0))
"""


@pytest.fixture(scope="module")
def cluster(tmp_path_factory):
    """A running SLURM; where there can be none, the tests are skipped with the reason."""
    if reason := unavailable_reason():
        pytest.skip(f"no SLURM: {reason}")
    cluster = Cluster(tmp_path_factory.mktemp("slurm"))
    try:
        cluster.start()
        yield cluster
    finally:
        cluster.stop()


@pytest.fixture
def slurm_folder(cluster, tmp_path, monkeypatch, root):
    """A folder; the environment says that work is sent to the cluster."""
    here = {
        "INDUSTNERF_RUNNER": "submitit",
        "INDUSTNERF_SLURM_FOLDER": str(tmp_path / "logs"),
        "INDUSTNERF_SLURM_POLL_S": "1",
        "INDUSTNERF_SLURM_PATIENCE_MIN": "1",
        "INDUSTNERF_STORE": str(tmp_path / "store"),
        "PYTHONPATH": f"{root}:{root / 'src'}",
    }
    for name, value in {**cluster.environment, **here}.items():
        monkeypatch.setenv(name, value)
    monkeypatch.chdir(root)
    return tmp_path


def wait_for_text(path):
    """The text of `path`, waiting for the file."""
    until = time.monotonic() + 60
    while not path.exists():
        assert time.monotonic() < until, f"{path} never appeared"
        time.sleep(0.1)
    return path.read_text()


@pytest.fixture
def in_background():
    """Starts a call in a thread; its result is to be waited for."""
    with ThreadPoolExecutor(1) as threads:
        yield threads.submit


@pytest.fixture
def small(root):
    """The smoke preset with one method that learns from other parts and one that does not."""
    methods = ["methods=[industnerf,mean_shape]", "evaluate.points=128"]
    with initialize_config_dir(str(root / "conf"), version_base="1.3"):
        values = OmegaConf.to_container(compose("config", ["experiment=smoke", *methods]))
    return build(Params, values)


def test_every_stage_writes_the_same_bytes_as_on_one_machine(slurm_folder, small, monkeypatch):
    """A sweep point from the parts to the report, with a store of its own on either side."""
    files_by_runner = {}
    for runner in ("process", "submitit"):
        monkeypatch.setenv("INDUSTNERF_RUNNER", runner)
        monkeypatch.setenv("INDUSTNERF_STORE", str(slurm_folder / f"store-{runner}"))
        run_pipeline(small, slurm_folder / runner)
        files = [path for path in (slurm_folder / runner).rglob("*") if path.is_file()]
        files_by_runner[runner] = {
            path.relative_to(slurm_folder / runner): path.read_bytes() for path in files
        }
    local_files, slurm_files = files_by_runner.values()
    assert local_files.keys() == slurm_files.keys()
    differing = {path for path in local_files if local_files[path] != slurm_files[path]}
    timed = {path for path in differing if path.name in TIMING_FILES or "metrics" in path.parts}
    assert differing == timed, sorted(differing - timed)
    for stage in ("parts", "views", "truth", "states", "clouds", "scores"):
        assert any(path.is_relative_to(f"data/{stage}") for path in local_files), stage
    assert not list((slurm_folder / "logs").iterdir()), "logs are kept only where something failed"


def test_a_job_that_dies_is_cancelled_or_has_a_failing_piece_costs_no_other(
    cluster, slurm_folder, in_background, monkeypatch
):
    """Four jobs of two pieces: one dies at its first, two are cancelled, in the last one fails.

    The second piece of the dead job is done by another; those of cancelled ones are not.
    """
    monkeypatch.setenv("INDUSTNERF_SLURM_CHUNK", "2")
    hanging = [partial(work_items.hang, slurm_folder / name) for name in "ab"]
    writing = [partial(work_items.write, slurm_folder / name) for name in "cdef"]
    pieces = [work_items.kill_own_job, *hanging, work_items.refuse, *writing]
    running = in_background(lambda: list(runner_from_environment().map(pieces, 60.0)))
    cluster.run("scancel", "--signal=KILL", killed := wait_for_text(slurm_folder / "a"))
    cluster.run("scancel", cancelled := wait_for_text(slurm_folder / "b"))
    results = {result.index: result for result in running.result(60)}
    assert re.match(
        r"SLURM job \d+_0 ended without a result: FAILED.*; its log: /", results[0].error
    )
    for index, job in ((1, killed), (2, cancelled)):
        error = results[index].error
        assert error.startswith(f"SLURM job {job} ended without a result: CANCELLED")
        assert results[index + 4].error == error
    assert results[3].error == "not closed"
    assert {i for i in results if results[i].error is None} == {4, 7}
    assert {i for i in results if results[i].lost} == {0, 1, 2, 5, 6}
    assert list((slurm_folder / "logs").glob("run-*/*_log.err"))


def test_jobs_that_run_together_have_a_gpu_each(slurm_folder, monkeypatch):
    """Neither ends before the other has begun; the node has two, which are files with a name."""
    monkeypatch.setenv("INDUSTNERF_SLURM_GRES", "gpu:1")
    gpu_files = [slurm_folder / "a", slurm_folder / "b"]
    pieces = [
        partial(work_items.write_own_gpu, own, other) for own, other in (gpu_files, gpu_files[::-1])
    ]
    results = list(runner_from_environment().map(pieces, 60.0))
    assert [result.error for result in results] == [None, None]
    assert {gpu_file.read_text() for gpu_file in gpu_files} == {"0", "1"}


def send_warning(cluster, job):
    """What SLURM sends before a job's time is over."""
    cluster.run("scancel", "--signal=USR2", job)


def preempt(cluster, job):
    """A job of a partition that goes before wants the whole node."""
    urgent = ("-p", "urgent", "--exclusive", "--output=/dev/null", "--wrap", "sleep 2")
    assert "Submitted" in cluster.run("sbatch", *urgent)


@pytest.mark.parametrize("interrupt", [send_warning, preempt])
def test_a_preempted_job_goes_on_where_it_was(
    cluster, slurm_folder, in_background, monkeypatch, interrupt
):
    monkeypatch.setenv("INDUSTNERF_SLURM_CHUNK", "2")
    count = partial(work_items.count, log=slurm_folder / "log")
    go_on = partial(work_items.resume, mark=slurm_folder / "mark")
    tasks = [
        Task("finished", count, 0, ()),
        Task("aside", count, 1, ()),
        Task("interrupted", go_on, 2, (), resumable=True),
        Task("aside too", count, 3, ()),
    ]
    running = in_background(run_stage, "s", tasks, slurm_folder / "out", "strict")
    interrupt(cluster, wait_for_text(slurm_folder / "mark"))
    running.result(100)
    assert (slurm_folder / "out" / "interrupted" / "result").read_text() == "half, 1"
    assert (slurm_folder / "log").read_text() == "called\n" * 3


def test_a_job_that_never_starts_is_given_up(cluster, slurm_folder, monkeypatch):
    monkeypatch.setenv("INDUSTNERF_SLURM_PARTITION", "closed")
    runner = runner_from_environment()
    runner = replace(runner, wait_settings=replace(runner.wait_settings, patience_s=1.8))
    [result] = runner.map([partial(work_items.write, slurm_folder / "a")], 60.0)
    assert "nothing heard for 0.03 min (INDUSTNERF_SLURM_PATIENCE_MIN): PENDING, " in result.error
    assert result.lost
    assert cluster.run("squeue", "-h", "-p", "closed") == ""


def test_a_stage_that_is_ended_while_sbatch_takes_its_jobs_leaves_none(
    cluster, slurm_folder, monkeypatch
):
    """An sbatch that is slow to answer has taken the jobs before the stage is told to end."""
    slow, taken = slurm_folder / "sbatch", slurm_folder / "taken"
    slow.write_text(f'#!/bin/sh\n{shutil.which("sbatch")} "$@"; touch {taken}; sleep 2\n')
    slow.chmod(0o755)
    monkeypatch.setenv("PATH", f"{slurm_folder}:{os.environ['PATH']}")
    monkeypatch.setenv("INDUSTNERF_SLURM_PARTITION", "closed")
    stage = subprocess.Popen([sys.executable, "-c", STAGE, str(slurm_folder / "mark")])
    wait_for_text(taken)
    stage.terminate()
    assert stage.wait(30) == 128 + signal.SIGTERM
    assert cluster.run("squeue", "-h", "-p", "closed") == ""


def test_what_sbatch_refuses_is_said(slurm_folder, monkeypatch):
    monkeypatch.setenv("INDUSTNERF_SLURM_PARTITION", "nowhere")
    with pytest.raises(BadParams, match=r"sbatch refused .*nowhere.*[Ii]nvalid partition"):
        list(runner_from_environment().map([work_items.refuse], 60.0))
