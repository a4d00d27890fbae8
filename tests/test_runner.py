"""Runners: one broken piece of work ends itself, not the others."""

import os
import signal
import time
from functools import partial

import pytest

from industnerf.errors import BadParams, BadPart
from industnerf.runner import ProcessRunner, SerialRunner, runner_from_environment

RUNNERS = [SerialRunner(), ProcessRunner(1), ProcessRunner(2)]


def write(path):
    path.write_text(os.environ.get("OMP_NUM_THREADS", ""))


def refuse():
    raise BadPart("not closed")


def fail():
    raise ZeroDivisionError("a bug")


def crash():
    os.kill(os.getpid(), signal.SIGSEGV)


def hang():
    time.sleep(60)


@pytest.mark.parametrize("runner", RUNNERS, ids=str)
def test_every_piece_of_work_has_one_outcome(runner, tmp_path):
    works = [partial(write, tmp_path / str(i)) for i in range(5)]
    works[1:1] = [refuse, fail]
    outcomes = sorted(runner.map(works, 60.0), key=lambda outcome: outcome.index)
    assert [outcome.index for outcome in outcomes] == list(range(7))
    assert [outcome.error is None for outcome in outcomes] == [True, False, False] + 4 * [True]
    assert outcomes[1].error == "not closed"
    assert outcomes[2].error.startswith("ZeroDivisionError: a bug")
    assert len(list(tmp_path.iterdir())) == 5


@pytest.mark.parametrize("workers", [1, 2])
def test_a_crash_and_a_hang_cost_themselves_only(workers, tmp_path):
    works = [crash, partial(write, tmp_path / "a"), hang, partial(write, tmp_path / "b")]
    outcomes = {o.index: o.error for o in ProcessRunner(workers).map(works, 6.0)}
    assert outcomes[0] == "crashed: its process ended with exit code -11"
    assert outcomes[2] == "timed out: more than 6 s"
    assert outcomes[1] is None
    assert outcomes[3] is None


def test_workers_have_one_thread_each(tmp_path):
    list(ProcessRunner(1).map([partial(write, tmp_path / "threads")], 60.0))
    assert (tmp_path / "threads").read_text() == "1"


def test_nothing_to_do_starts_nothing():
    assert list(ProcessRunner(2).map([], 1.0)) == []


def test_an_unknown_runner_or_count_is_named(monkeypatch):
    monkeypatch.setenv("INDUSTNERF_RUNNER", "cloud")
    with pytest.raises(BadParams, match="INDUSTNERF_RUNNER is 'cloud'"):
        runner_from_environment()
    monkeypatch.setenv("INDUSTNERF_RUNNER", "process")
    monkeypatch.setenv("INDUSTNERF_WORKERS", "many")
    with pytest.raises(BadParams, match="INDUSTNERF_WORKERS is 'many'"):
        runner_from_environment()
