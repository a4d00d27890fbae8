"""Runners: one broken piece of work ends itself, not the others."""

import errno
import os
import resource
import signal
import time
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from industnerf.artifacts.whole import written_whole
from industnerf.errors import BadParams, BadPart
from industnerf.runner import ProcessRunner, SerialRunner, processes, runner_from_environment
from industnerf.runner.base import attempt

RUNNERS = [SerialRunner(), ProcessRunner(1), ProcessRunner(2)]


def write(path):
    path.write_text(os.environ.get("OMP_NUM_THREADS", ""))


def refuse():
    raise BadPart("not closed")


def fail():
    raise ZeroDivisionError("a bug")


def note_process(path):
    path.write_text(str(os.getpid()))


def fail_saying(text):
    raise RuntimeError(text)


def fill_disk():
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), "cloud.npz")


def fill_disk_behind_a_refusal():
    """What is left of it by whom a file is written whole."""
    with written_whole(Path("cloud.json")):
        fill_disk()


def read_what_is_closed_to_it():
    raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), "part.step")


def crash():
    os.kill(os.getpid(), signal.SIGSEGV)


def kill():
    os.kill(os.getpid(), signal.SIGKILL)


def hang():
    time.sleep(60)


def sleep(seconds):
    time.sleep(seconds)


def gobble():
    """One block of 2 GB; nothing is touched, so only the address space grows."""
    np.empty(2 * 2**30, np.uint8)


def end_itself(how, path):
    """Send itself the signal `how`, as SLURM sends it to every process of a job."""
    os.kill(os.getpid(), how)
    path.write_text("alive")


def nibble(path):
    """64 MB, and what the limit is meanwhile."""
    np.empty(2**26, np.uint8)
    path.write_text(str(resource.getrlimit(resource.RLIMIT_AS)[0]))


def abort():
    """What C++ does where it cannot allocate and nobody catches."""
    os.abort()


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
    assert outcomes[2] == "timed out: more than 6 s (time_limit_s)"
    assert outcomes[1] is None
    assert outcomes[3] is None


def test_the_time_in_which_all_is_stopped_does_not_count(tmp_path, monkeypatch):
    """6 s pass in the first look, as after Ctrl-Z and `fg`; the piece of 7 s may take 5."""
    first, wait = [6.0], processes.wait

    def stopped(connections, timeout):
        if first:
            time.sleep(first.pop())
            return []
        return wait(connections, timeout)

    monkeypatch.setattr(processes, "wait", stopped)
    works = [partial(sleep, 7.0), partial(write, tmp_path / "a")]
    outcomes = {o.index: o.error for o in ProcessRunner(1).map(works, 5.0)}
    assert outcomes == {0: None, 1: None}


def test_a_piece_that_needs_too_much_memory_costs_itself_only(tmp_path):
    works = [gobble, partial(nibble, tmp_path / "a"), abort, partial(nibble, tmp_path / "b")]
    outcomes = {o.index: o.error for o in ProcessRunner(1).map(works, 60.0, 1500)}
    assert outcomes[0] == "out of memory: needs more than 1500 MB (memory_limit_mb)"
    assert outcomes[1] is None
    assert outcomes[2] == (
        "crashed: its process ended with exit code -6; it may have needed more than 1500 MB "
        "(memory_limit_mb)"
    )
    assert outcomes[3] is None
    assert (tmp_path / "a").read_text() == str(1500 * 2**20)


def test_the_memory_limit_ends_with_the_piece_of_work(tmp_path):
    """The process that did `nibble` under a limit then allocates 2 GB without one."""
    before = resource.getrlimit(resource.RLIMIT_AS)
    assert attempt(partial(nibble, tmp_path / "a"), 100_000) is None
    assert resource.getrlimit(resource.RLIMIT_AS) == before
    assert (tmp_path / "a").read_text() == str(100_000 * 2**20)
    assert attempt(gobble, None) is None


@pytest.mark.parametrize("runner", RUNNERS)
def test_a_full_disk_says_nothing_of_the_piece_of_work_and_a_closed_file_does(runner):
    works = [fill_disk, fill_disk_behind_a_refusal, read_what_is_closed_to_it, fail]
    outcomes = {outcome.index: outcome for outcome in runner.map(works, 60.0)}
    assert [outcomes[index].lost for index in range(4)] == [True, True, False, False]
    assert outcomes[1].error == "cloud.json: cannot be written: No space left on device"
    assert outcomes[0].error.startswith("OSError: [Errno 28] No space left on device: 'cloud.npz'")


def test_a_worker_that_is_killed_between_two_pieces_costs_none(tmp_path):
    """As the kernel kills who sits idle on much memory; an outcome in hand, no piece is begun."""
    works = [partial(note_process, tmp_path / name) for name in "ab"]
    outcomes = ProcessRunner(1).map(works, 60.0)
    first = next(outcomes)
    idle = int((tmp_path / "a").read_text())
    os.kill(idle, signal.SIGKILL)
    while Path(f"/proc/{idle}/stat").read_text().split()[2] != "Z":
        time.sleep(0.01)
    assert [outcome.error for outcome in (first, *outcomes)] == [None, None]
    assert (tmp_path / "b").read_text() != str(idle)


@pytest.mark.parametrize(
    "said",
    [
        "CUDA out of memory. Tried to allocate 2.00 GiB. GPU 0 has a total capacity of 3 GiB",
        "CUDA error: out of memory",
        "CUDA error: CUBLAS_STATUS_ALLOC_FAILED when calling `cublasCreate(handle)`",
        "Failed to allocate 4096 bytes on device 'cuda:0'",
    ],
)
def test_a_full_gpu_says_nothing_of_the_piece_of_work(said):
    fault = attempt(partial(fail_saying, said), None)
    assert fault.lost
    assert fault.text.endswith("fewer INDUSTNERF_WORKERS leave more of the GPU to each")
    assert not attempt(partial(fail_saying, "shapes differ"), None).lost


def test_a_process_whose_gpu_fails_does_no_other_piece(tmp_path):
    """Every call to the device would fail in it: one bad piece would spoil all that follow."""
    works = [
        partial(note_process, tmp_path / "a"),
        partial(fail_saying, "CUDA error: an illegal memory access was encountered"),
        partial(note_process, tmp_path / "b"),
    ]
    outcomes = {outcome.index: outcome for outcome in ProcessRunner(1).map(works, 60.0)}
    assert [outcomes[index].error is None for index in range(3)] == [True, False, True]
    assert not outcomes[1].lost
    assert (tmp_path / "a").read_text() != (tmp_path / "b").read_text()


@pytest.mark.parametrize("limit_mb", [None, 100_000])
def test_what_the_kernel_killed_says_nothing_of_the_piece(limit_mb, monkeypatch):
    """It kills where memory is short, of which other processes may have left little."""
    monkeypatch.setattr(processes, "KILL_S", 0.0)
    (outcome,) = ProcessRunner(1).map([kill], 60.0, limit_mb)
    assert outcome.lost
    assert outcome.error == (
        "crashed: its process ended with exit code -9; fewer INDUSTNERF_WORKERS leave more memory "
        "to each"
    )


def test_signals_that_are_meant_for_the_job_do_not_reach_its_pieces(tmp_path):
    both = (signal.SIGTERM, signal.SIGUSR2)
    works = [partial(end_itself, how, tmp_path / how.name) for how in both]
    reached = list(ProcessRunner(1).map(works, 60.0))
    assert [outcome.error[-3:] for outcome in reached] == ["-15", "-12"]
    assert not list(tmp_path.iterdir())
    assert all(outcome.error is None for outcome in ProcessRunner(1, both).map(works, 60.0))
    assert len(list(tmp_path.iterdir())) == 2
    assert signal.pthread_sigmask(signal.SIG_BLOCK, ()).isdisjoint(both)


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
