"""Locks of processes that are dead, stopped, or somebody else."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from industnerf.doctor import processes
from tests.doctor.conftest import WorkingCopy

HOLD = """
import fcntl, sys, time
lock = open(sys.argv[1], "a")
fcntl.flock(lock, fcntl.LOCK_EX)
print("held", flush=True)
time.sleep(600)
"""


@pytest.fixture
def sleeper() -> Iterator[subprocess.Popen]:
    """A process that has nothing to do with DVC."""
    process = subprocess.Popen(["sleep", "600"])
    yield process
    process.kill()
    process.wait()


@pytest.fixture
def lock_process(bare_copy: WorkingCopy) -> Iterator[subprocess.Popen]:
    """A process that holds the lock of the database."""
    arguments = [sys.executable, "-c", HOLD, str(bare_copy.folder / "mlflow.db.lock")]
    process = subprocess.Popen(arguments, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    assert process.stdout.readline() == "held\n"
    yield process
    process.kill()
    process.communicate()


def wait_for(condition) -> None:
    deadline = time.monotonic() + 60
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.01)


def start_paused_dvc(dvc_copy: WorkingCopy) -> subprocess.Popen:
    """A DVC whose stage is at work: before that it takes its lock and drops it more than once."""
    at_work = dvc_copy.folder / "at-work"
    at_work.unlink(missing_ok=True)
    (dvc_copy.folder / "pause").write_text("600")
    process = dvc_copy.start("exec dvc repro -f")
    wait_for(at_work.exists)
    return process


def test_locks_that_nobody_holds_are_right(dvc_copy: WorkingCopy):
    assert (dvc_copy.folder / ".dvc/tmp/lock").exists()
    assert dvc_copy.check("locks") == []


def test_a_torn_rwlock_stops_dvc_and_is_mended(dvc_copy: WorkingCopy):
    (dvc_copy.folder / ".dvc/tmp/rwlock").write_text('{"write": {')
    assert "corrupted" in dvc_copy.run("dvc repro -f")[1]
    dvc_copy.fix("locks")
    assert dvc_copy.run("dvc repro -f")[0] == 0


def test_a_rwlock_that_dvc_is_writing_is_not_torn(dvc_copy: WorkingCopy, monkeypatch):
    """It empties the file first, and is done a moment later."""
    rwlock = dvc_copy.folder / ".dvc/tmp/rwlock"
    rwlock.write_text("")
    done = '{"write": {}, "read": {}}'
    monkeypatch.setattr("industnerf.doctor.locks.time.sleep", lambda _: rwlock.write_text(done))
    assert dvc_copy.check("locks") == []
    assert rwlock.read_text() == done


def test_a_number_that_another_process_has_by_now_blocks_dvc(
    dvc_copy: WorkingCopy, sleeper: subprocess.Popen
):
    entry = {"pid": sleeper.pid, "cmd": "/usr/bin/dvc repro"}
    lock = {"write": {str(dvc_copy.folder / "data/out"): entry}, "read": {}}
    (dvc_copy.folder / ".dvc/tmp/rwlock").write_text(json.dumps(lock))
    assert "is busy" in dvc_copy.run("dvc repro -f")[1]
    (finding,) = dvc_copy.check("locks")
    assert f"names process {sleeper.pid} as /usr/bin/dvc repro, but that is now sleep 600" in (
        finding.message
    )
    dvc_copy.fix("locks")
    assert dvc_copy.run("dvc repro -f")[0] == 0


def test_a_lock_that_a_dvc_at_work_is_in_too_is_left(
    dvc_copy: WorkingCopy, sleeper: subprocess.Popen
):
    """To remove the file would take its lock from it, and let a second DVC in."""
    rwlock = dvc_copy.folder / ".dvc/tmp/rwlock"
    process = start_paused_dvc(dvc_copy)
    try:
        content = json.loads(rwlock.read_text())
        content["write"]["elsewhere"] = {"pid": sleeper.pid, "cmd": "dvc repro"}
        rwlock.write_text(json.dumps(content))
        findings = [one for one in dvc_copy.check("locks") if one.path == rwlock]
    finally:
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
        (dvc_copy.folder / "pause").write_text("0")
    rwlock.unlink()  # with the two that are in it; the project is shared by tests
    (foreign,) = [one for one in findings if one.is_error]
    assert foreign.message.endswith("ask again when the DVC that is at work has ended")
    assert foreign.fix == ""


def test_a_killed_dvc_is_told_of_and_needs_no_mending(dvc_copy: WorkingCopy):
    process = start_paused_dvc(dvc_copy)
    try:
        busy = dvc_copy.check("locks")
    finally:
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
        (dvc_copy.folder / "pause").write_text("0")
    assert busy
    assert all(finding.message.endswith("is at work") for finding in busy)
    (finding,) = dvc_copy.check("locks")
    assert f"names process {process.pid}" in finding.message
    assert not finding.is_error
    assert dvc_copy.run("dvc repro -f")[0] == 0


def test_a_process_at_work_is_told_of(bare_copy: WorkingCopy, lock_process: subprocess.Popen):
    (finding,) = bare_copy.check("locks")
    assert f"held by process {lock_process.pid}" in finding.message
    assert not finding.is_error


def test_a_lock_on_another_disk_is_not_ours(
    bare_copy: WorkingCopy, lock_process: subprocess.Popen, monkeypatch: pytest.MonkeyPatch
):
    """Numbers of files are unique on a disk alone; only who has the file open may hold it."""
    lock = bare_copy.folder / "mlflow.db.lock"
    assert processes.lock_holder(lock) == lock_process.pid
    own_stat = lock.stat()
    other_stat = os.stat_result((*own_stat[:2], own_stat.st_dev + 1, *own_stat[3:]))
    monkeypatch.setattr(Path, "stat", lambda path: other_stat if path == lock else os.stat(path))
    assert processes.lock_holder(lock) is None


def test_a_stopped_process_is_woken(bare_copy: WorkingCopy, lock_process: subprocess.Popen):
    lock_process.send_signal(signal.SIGSTOP)
    wait_for(lambda: any(finding.fix for finding in bare_copy.check("locks")))
    bare_copy.fix("locks")
