"""The runner against a real SLURM of one node, which the tests start and end themselves."""

import re
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
import trimesh

from industnerf.artifacts.files import write_json
from industnerf.artifacts.part import Mesh, save_part
from industnerf.config import load_params, stage
from industnerf.errors import BadParams
from industnerf.runner import runner_from_environment
from industnerf.stage import Task, run_stage
from pipeline import views
from tests.samples import unit_part
from tests.slurm import works
from tests.slurm.cluster import Cluster, why_not

pytestmark = pytest.mark.slurm


@pytest.fixture(scope="module")
def cluster(tmp_path_factory):
    """A running SLURM; where there can be none, the tests are skipped with the reason."""
    if reason := why_not():
        pytest.skip(f"no SLURM: {reason}")
    cluster = Cluster(tmp_path_factory.mktemp("slurm"))
    try:
        cluster.start()
        yield cluster
    finally:
        cluster.stop()


@pytest.fixture
def place(cluster, tmp_path, monkeypatch, root):
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


def appears(path):
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
def photographed(place, root, monkeypatch):
    """Runs the stage `views` on two small parts with a store of its own; what it left, in bytes."""
    solids = {"box": trimesh.creation.box((3, 4, 5)), "ball": trimesh.creation.icosphere()}
    for name, solid in solids.items():
        mesh = Mesh.plain(np.array(solid.vertices, float), np.array(solid.faces, np.int32))
        extents = tuple(np.ptp(mesh.vertices, axis=0).tolist())
        (place / "parts" / name).mkdir(parents=True)
        save_part(place / "parts" / name, unit_part(name, extents_mm=extents), mesh)
    write_json(place / "parts" / "index.json", {"schema": 1, "keys": dict.fromkeys(solids, "")})
    write_json(place / "parts" / "failures.json", {"schema": 1, "failures": {}})
    params = load_params(root / "params.yaml")
    small = replace(params, views=replace(params.views, resolution=32, count=3, held_out=1))
    mask = stage("views", path=root / "dvc.yaml").mask(small)

    def run(runner):
        monkeypatch.setenv("INDUSTNERF_RUNNER", runner)
        monkeypatch.setenv("INDUSTNERF_STORE", str(place / f"store-{runner}"))
        out = place / runner / "views"
        views.main(mask, str(place / "parts"), str(out))
        return {p.relative_to(out): p.read_bytes() for p in out.rglob("*") if p.is_file()}

    return run


def test_photographs_are_the_same_bytes_as_on_one_machine(photographed, place):
    here, there = photographed("process"), photographed("submitit")
    assert sum(path.suffix == ".png" for path in here) >= 2 * 4
    assert here == there
    assert not list((place / "logs").iterdir()), "logs are kept only where something failed"


def test_a_job_that_dies_is_cancelled_or_has_a_failing_piece_costs_no_other(
    cluster, place, in_background, monkeypatch
):
    """Four jobs of two pieces: one dies at its first, two are cancelled, in the last one fails.

    The second piece of the dead job is done by another; those of cancelled ones are not.
    """
    monkeypatch.setenv("INDUSTNERF_SLURM_CHUNK", "2")
    hanging = [partial(works.hang, place / name) for name in "ab"]
    writing = [partial(works.write, place / name) for name in "cdef"]
    pieces = [works.end_its_job, *hanging, works.refuse, *writing]
    running = in_background(lambda: list(runner_from_environment().map(pieces, 60.0)))
    cluster.run("scancel", "--signal=KILL", killed := appears(place / "a"))
    cluster.run("scancel", cancelled := appears(place / "b"))
    outcomes = {outcome.index: outcome for outcome in running.result(60)}
    assert re.match(
        r"SLURM job \d+_0 ended without a result: FAILED.*; its log: /", outcomes[0].error
    )
    for index, job in ((1, killed), (2, cancelled)):
        why = outcomes[index].error
        assert why.startswith(f"SLURM job {job} ended without a result: CANCELLED")
        assert outcomes[index + 4].error == why
    assert outcomes[3].error == "not closed"
    assert {i for i in outcomes if outcomes[i].error is None} == {4, 7}
    assert {i for i in outcomes if outcomes[i].lost} == {0, 1, 2, 5, 6}
    assert list((place / "logs").glob("run-*/*_log.err"))


def test_a_preempted_job_goes_on_where_it_was(cluster, place, in_background, monkeypatch):
    monkeypatch.setenv("INDUSTNERF_SLURM_CHUNK", "2")
    count = partial(works.count, log=place / "log")
    go_on = partial(works.go_on, mark=place / "mark")
    tasks = [
        Task("finished", count, 0, ()),
        Task("aside", count, 1, ()),
        Task("interrupted", go_on, 2, (), resumable=True),
        Task("aside too", count, 3, ()),
    ]
    running = in_background(run_stage, "s", tasks, place / "out", "strict")
    cluster.run("scancel", "--signal=USR2", appears(place / "mark"))
    running.result(100)
    assert (place / "out" / "interrupted" / "result").read_text() == "half, 1"
    assert (place / "log").read_text() == "called\n" * 3


def test_a_job_that_never_starts_is_given_up(cluster, place, monkeypatch):
    monkeypatch.setenv("INDUSTNERF_SLURM_PARTITION", "closed")
    runner = runner_from_environment()
    runner = replace(runner, waiting=replace(runner.waiting, patience_s=1.8))
    [outcome] = runner.map([partial(works.write, place / "a")], 60.0)
    assert "nothing heard for 0.03 min (INDUSTNERF_SLURM_PATIENCE_MIN): PENDING, " in outcome.error
    assert outcome.lost
    assert cluster.run("squeue", "-h", "-p", "closed") == ""


def test_what_sbatch_refuses_is_said(place, monkeypatch):
    monkeypatch.setenv("INDUSTNERF_SLURM_PARTITION", "nowhere")
    with pytest.raises(BadParams, match=r"sbatch refused .*nowhere.*[Ii]nvalid partition"):
        list(runner_from_environment().map([works.refuse], 60.0))
