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
def holder(plain: WorkingCopy) -> Iterator[subprocess.Popen]:
    """A process that holds the lock of the database."""
    arguments = [sys.executable, "-c", HOLD, str(plain.folder / "mlflow.db.lock")]
    process = subprocess.Popen(arguments, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    assert process.stdout.readline() == "held\n"
    yield process
    process.kill()
    process.communicate()


def wait_for(holds) -> None:
    deadline = time.monotonic() + 60
    while not holds():
        assert time.monotonic() < deadline
        time.sleep(0.01)


def test_locks_that_nobody_holds_are_right(copy: WorkingCopy):
    assert (copy.folder / ".dvc/tmp/lock").exists()
    assert copy.find("locks") == []


def test_a_torn_rwlock_stops_dvc_and_is_mended(copy: WorkingCopy):
    (copy.folder / ".dvc/tmp/rwlock").write_text('{"write": {')
    assert "corrupted" in copy.run("dvc repro -f")[1]
    copy.mend("locks")
    assert copy.run("dvc repro -f")[0] == 0


def test_a_rwlock_that_dvc_is_writing_is_not_torn(copy: WorkingCopy, monkeypatch):
    """It empties the file first, and is done a moment later."""
    rwlock = copy.folder / ".dvc/tmp/rwlock"
    rwlock.write_text("")
    done = '{"write": {}, "read": {}}'
    monkeypatch.setattr("industnerf.doctor.locks.time.sleep", lambda _: rwlock.write_text(done))
    assert copy.find("locks") == []
    assert rwlock.read_text() == done


def test_a_number_that_another_process_has_by_now_blocks_dvc(
    copy: WorkingCopy, sleeper: subprocess.Popen
):
    entry = {"pid": sleeper.pid, "cmd": "/usr/bin/dvc repro"}
    lock = {"write": {str(copy.folder / "data/out"): entry}, "read": {}}
    (copy.folder / ".dvc/tmp/rwlock").write_text(json.dumps(lock))
    assert "is busy" in copy.run("dvc repro -f")[1]
    (finding,) = copy.find("locks")
    assert f"names process {sleeper.pid} as /usr/bin/dvc repro, but that is now sleep 600" in (
        finding.what
    )
    copy.mend("locks")
    assert copy.run("dvc repro -f")[0] == 0


def test_a_lock_that_a_dvc_at_work_is_in_too_is_left(copy: WorkingCopy, sleeper: subprocess.Popen):
    """To remove the file would take its lock from it, and let a second DVC in."""
    rwlock = copy.folder / ".dvc/tmp/rwlock"
    (copy.folder / "pause").write_text("600")
    process = copy.start("exec dvc repro -f")
    try:
        wait_for(lambda: rwlock.exists() and f'"pid": {process.pid}' in rwlock.read_text())
        content = json.loads(rwlock.read_text())
        content["write"]["elsewhere"] = {"pid": sleeper.pid, "cmd": "dvc repro"}
        rwlock.write_text(json.dumps(content))
        found = [one for one in copy.find("locks") if one.where == rwlock]
    finally:
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
        (copy.folder / "pause").write_text("0")
    rwlock.unlink()  # with the two that are in it; the project is shared by tests
    (foreign,) = [one for one in found if one.is_wrong]
    assert foreign.what.endswith("ask again when the DVC that is at work has ended")
    assert foreign.mend == ""


def test_a_killed_dvc_is_told_of_and_needs_no_mending(copy: WorkingCopy):
    rwlock = copy.folder / ".dvc/tmp/rwlock"
    (copy.folder / "pause").write_text("600")
    process = copy.start("exec dvc repro -f")
    try:
        wait_for(lambda: rwlock.exists() and f'"pid": {process.pid}' in rwlock.read_text())
        busy = copy.find("locks")
    finally:
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
        (copy.folder / "pause").write_text("0")
    assert busy
    assert all(finding.what.endswith("is at work") for finding in busy)
    (finding,) = copy.find("locks")
    assert f"names process {process.pid}" in finding.what
    assert not finding.is_wrong
    assert copy.run("dvc repro -f")[0] == 0


def test_a_process_at_work_is_told_of(plain: WorkingCopy, holder: subprocess.Popen):
    (finding,) = plain.find("locks")
    assert f"held by process {holder.pid}" in finding.what
    assert not finding.is_wrong


def test_a_lock_on_another_disk_is_not_ours(
    plain: WorkingCopy, holder: subprocess.Popen, monkeypatch: pytest.MonkeyPatch
):
    """Numbers of files are unique on a disk alone; only who has the file open may hold it."""
    lock = plain.folder / "mlflow.db.lock"
    assert processes.holder(lock) == holder.pid
    known = lock.stat()
    there = os.stat_result((*known[:2], known.st_dev + 1, *known[3:]))
    monkeypatch.setattr(Path, "stat", lambda path: there if path == lock else os.stat(path))
    assert processes.holder(lock) is None


def test_a_stopped_process_is_woken(plain: WorkingCopy, holder: subprocess.Popen):
    holder.send_signal(signal.SIGSTOP)
    wait_for(lambda: any(finding.mend for finding in plain.find("locks")))
    plain.mend("locks")
