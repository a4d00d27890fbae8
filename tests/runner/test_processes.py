"""Runners: one broken piece of work ends itself, not the others."""

import errno
import mmap
import os
import resource
import signal
import time
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from industnerf.artifacts.files import atomic_write
from industnerf.errors import BadParams, BadPart, ReconstructionFailed
from industnerf.runner import (
    GroupedWork,
    ProcessRunner,
    SerialRunner,
    processes,
    runner_from_environment,
)
from industnerf.runner.base import next_piece, run_work_item

RUNNERS = [SerialRunner(), ProcessRunner(1), ProcessRunner(2)]


def write(path):
    path.write_text(os.environ.get("OMP_NUM_THREADS", ""))


def refuse():
    raise BadPart("not closed")


def fail():
    raise ZeroDivisionError("a bug")


def note_process(path):
    path.write_text(str(os.getpid()))


def fail_with(text):
    raise RuntimeError(text)


def fill_disk():
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), "cloud.npz")


def fill_disk_behind_a_refusal():
    """What is left of it by whom a file is written whole."""
    with atomic_write(Path("cloud.json")):
        fill_disk()


def read_forbidden_file():
    raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), "part.step")


def crash():
    os.kill(os.getpid(), signal.SIGSEGV)


def kill():
    os.kill(os.getpid(), signal.SIGKILL)


def hang():
    time.sleep(60)


def sleep(seconds):
    time.sleep(seconds)


def allocate_2_gb():
    """One block of 2 GB; nothing is touched, so only the address space grows."""
    np.empty(2 * 2**30, np.uint8)


def end_itself(signum, path):
    """Send itself `signum`, as SLURM sends it to every process of a job."""
    os.kill(os.getpid(), signum)
    path.write_text("alive")


def allocate_64_mb(path):
    """64 MB, and what the limit is meanwhile."""
    np.empty(2**26, np.uint8)
    path.write_text(str(resource.getrlimit(resource.RLIMIT_AS)[0]))


def abort():
    """What C++ does where it cannot allocate and nobody catches."""
    os.abort()


@pytest.mark.parametrize("runner", RUNNERS, ids=str)
def test_every_piece_of_work_has_one_outcome(runner, tmp_path):
    work_items = [partial(write, tmp_path / str(i)) for i in range(5)]
    work_items[1:1] = [refuse, fail]
    results = sorted(runner.map(work_items, 60.0), key=lambda result: result.index)
    assert [result.index for result in results] == list(range(7))
    assert [result.error is None for result in results] == [True, False, False] + 4 * [True]
    assert results[1].error == "not closed"
    assert results[2].error.startswith("ZeroDivisionError: a bug")
    assert len(list(tmp_path.iterdir())) == 5


@pytest.mark.parametrize("workers", [1, 2])
def test_a_crash_and_a_hang_cost_themselves_only(workers, tmp_path):
    work_items = [crash, partial(write, tmp_path / "a"), hang, partial(write, tmp_path / "b")]
    results = {each.index: each.error for each in ProcessRunner(workers).map(work_items, 6.0)}
    assert results[0] == "crashed: its process ended with exit code -11"
    assert results[2] == "timed out: more than 6 s (time_limit_s)"
    assert results[1] is None
    assert results[3] is None


def test_the_time_in_which_all_is_stopped_does_not_count(tmp_path, monkeypatch):
    """6 s pass in the first look, as after Ctrl-Z and `fg`; the piece of 7 s may take 5."""
    first, wait = [6.0], processes.wait

    def stopped(connections, timeout):
        if first:
            time.sleep(first.pop())
            return []
        return wait(connections, timeout)

    monkeypatch.setattr(processes, "wait", stopped)
    work_items = [partial(sleep, 7.0), partial(write, tmp_path / "a")]
    results = {each.index: each.error for each in ProcessRunner(1).map(work_items, 5.0)}
    assert results == {0: None, 1: None}


def test_a_piece_that_needs_too_much_memory_costs_itself_only(tmp_path):
    work_items = [
        allocate_2_gb,
        partial(allocate_64_mb, tmp_path / "a"),
        abort,
        partial(allocate_64_mb, tmp_path / "b"),
    ]
    results = {each.index: each.error for each in ProcessRunner(1).map(work_items, 60.0, 1500)}
    assert results[0] == "out of memory: needs more than 1500 MB (memory_limit_mb)"
    assert results[1] is None
    assert results[2] == (
        "crashed: its process ended with exit code -6; it may have needed more than 1500 MB "
        "(memory_limit_mb)"
    )
    assert results[3] is None
    assert (tmp_path / "a").read_text() == str(1500 * 2**20)


def test_the_memory_limit_ends_with_the_piece_of_work(tmp_path):
    """The process that did `nibble` under a limit then allocates 2 GB without one."""
    before = resource.getrlimit(resource.RLIMIT_AS)
    assert run_work_item(partial(allocate_64_mb, tmp_path / "a"), 100_000) is None
    assert resource.getrlimit(resource.RLIMIT_AS) == before
    assert (tmp_path / "a").read_text() == str(100_000 * 2**20)
    assert run_work_item(allocate_2_gb, None) is None


@pytest.mark.parametrize("runner", RUNNERS)
def test_a_full_disk_says_nothing_of_the_piece_of_work_and_a_closed_file_does(runner):
    work_items = [fill_disk, fill_disk_behind_a_refusal, read_forbidden_file, fail]
    results = {result.index: result for result in runner.map(work_items, 60.0)}
    assert [results[index].lost for index in range(4)] == [True, True, False, False]
    assert results[1].error == "cloud.json: cannot be written: No space left on device"
    assert results[0].error.startswith("OSError: [Errno 28] No space left on device: 'cloud.npz'")


def test_a_worker_that_is_killed_between_two_pieces_costs_none(tmp_path):
    """As the kernel kills who sits idle on much memory; an outcome in hand, no piece is begun."""
    work_items = [partial(note_process, tmp_path / name) for name in "ab"]
    results = ProcessRunner(1).map(work_items, 60.0)
    first = next(results)
    idle = int((tmp_path / "a").read_text())
    os.kill(idle, signal.SIGKILL)
    while Path(f"/proc/{idle}/stat").read_text().split()[2] != "Z":
        time.sleep(0.01)
    assert [result.error for result in (first, *results)] == [None, None]
    assert (tmp_path / "b").read_text() != str(idle)


@pytest.mark.parametrize(
    "message",
    [
        "CUDA out of memory. Tried to allocate 2.00 GiB. GPU 0 has a total capacity of 3 GiB",
        "CUDA error: out of memory",
        "CUDA error: CUBLAS_STATUS_ALLOC_FAILED when calling `cublasCreate(handle)`",
        "Failed to allocate 4096 bytes on device 'cuda:0'",
    ],
)
def test_a_full_gpu_says_nothing_of_the_piece_of_work(message):
    error = run_work_item(partial(fail_with, message), None)
    assert error.lost
    assert error.text.endswith("fewer INDUSTNERF_WORKERS leave more of the GPU to each")
    assert not run_work_item(partial(fail_with, "shapes differ"), None).lost


def allocate_more_than_there_is(library):
    """2^50 bytes, which no kernel grants, in the words of each library."""
    if library == "numpy":
        np.empty(2**50, np.uint8)
    elif library == "torch":
        import torch

        torch.empty(2**50, dtype=torch.uint8)
    elif library == "warp":
        import warp

        from industnerf.geometry.warp_runtime import init_warp

        init_warp()
        warp.empty((2**20, 2**30), dtype=warp.uint8, device="cpu")
    else:
        mmap.mmap(-1, 2**50)


def fail_behind_a_refusal(library):
    try:
        allocate_more_than_there_is(library)
    except Exception:
        raise ReconstructionFailed("no cloud") from None


@pytest.mark.parametrize("work_item", [allocate_more_than_there_is, fail_behind_a_refusal])
@pytest.mark.parametrize("library", ["numpy", "torch", "warp", "mmap"])
def test_want_of_memory_says_nothing_of_the_piece_in_whatever_words(library, work_item):
    error = run_work_item(partial(work_item, library), None)
    assert error.lost
    limited = run_work_item(partial(work_item, library), 100_000)
    assert not limited.lost
    assert limited.text == "out of memory: needs more than 100000 MB (memory_limit_mb)"


def test_a_process_whose_gpu_fails_does_no_other_piece(tmp_path):
    """Every call to the device would fail in it: one bad piece would spoil all that follow."""
    work_items = [
        partial(note_process, tmp_path / "a"),
        partial(fail_with, "CUDA error: an illegal memory access was encountered"),
        partial(note_process, tmp_path / "b"),
    ]
    results = {result.index: result for result in ProcessRunner(1).map(work_items, 60.0)}
    assert [results[index].error is None for index in range(3)] == [True, False, True]
    assert not results[1].lost
    assert (tmp_path / "a").read_text() != (tmp_path / "b").read_text()


@pytest.mark.parametrize("limit_mb", [None, 100_000])
def test_what_the_kernel_killed_says_nothing_of_the_piece(limit_mb, monkeypatch):
    """It kills where memory is short, of which other processes may have left little."""
    monkeypatch.setattr(processes, "KILL_GRACE_S", 0.0)
    (result,) = ProcessRunner(1).map([kill], 60.0, limit_mb)
    assert result.lost
    assert result.error == (
        "crashed: its process ended with exit code -9; fewer INDUSTNERF_WORKERS leave more memory "
        "to each"
    )


def test_signals_that_are_meant_for_the_job_do_not_reach_its_pieces(tmp_path):
    both = (signal.SIGTERM, signal.SIGUSR2)
    work_items = [partial(end_itself, signum, tmp_path / signum.name) for signum in both]
    results = list(ProcessRunner(1).map(work_items, 60.0))
    assert [result.error[-3:] for result in results] == ["-15", "-12"]
    assert not list(tmp_path.iterdir())
    assert all(result.error is None for result in ProcessRunner(1, both).map(work_items, 60.0))
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


def test_no_process_does_pieces_of_two_groups(tmp_path):
    """What a method leaves in memory would count for the next one."""
    groups = ["hull", "hull", "nerf", "nerf", "hull"]
    pieces = [
        GroupedWork(partial(note_process, tmp_path / str(i)), group)
        for i, group in enumerate(groups)
    ]
    assert [result.error for result in ProcessRunner(1).map(pieces, 60.0)] == [None] * 5
    a, b, c, d, e = ((tmp_path / str(i)).read_text() for i in range(5))
    assert (a, c) == (b, d)
    assert a == e != c  # it does all pieces of a group before it begins another


def test_processes_divide_groups_before_they_share_one():
    groups = ["hull", "hull", "nerf", "nerf", "carve"]
    assert next_piece([0, 1, 2, 3, 4], groups, None, set()) == 0
    assert next_piece([1, 2, 3, 4], groups, None, {"hull"}) == 2
    assert next_piece([1, 3, 4], groups, "hull", {"nerf"}) == 1
    assert next_piece([3, 4], groups, "hull", {"nerf"}) == 4
    assert next_piece([3], groups, "hull", {"nerf"}) == 3
