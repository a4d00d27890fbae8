"""What /proc says of processes, asked about processes of the test's own."""

import fcntl
import os
import subprocess
import time
from pathlib import Path

from industnerf.doctor.processes import command_line, is_alive, lock_holder, process_state


def test_this_process_lives_and_has_a_command():
    assert is_alive(os.getpid())
    assert process_state(os.getpid()) in ("R", "S")
    assert "python" in command_line(os.getpid())


def test_a_process_that_nobody_has_reaped_is_dead():
    process = subprocess.Popen(["true"])
    deadline = time.monotonic() + 60
    while process_state(process.pid) != "Z":
        assert time.monotonic() < deadline
        time.sleep(0.01)
    assert not is_alive(process.pid)
    process.wait()
    assert not is_alive(process.pid)
    assert process_state(process.pid) == command_line(process.pid) == ""


def test_who_holds_a_lock_is_known_while_it_is_held(tmp_path: Path):
    path = tmp_path / "lock"
    with path.open("w") as file, (tmp_path / "other").open("w") as other:
        fcntl.flock(other, fcntl.LOCK_EX)
        assert lock_holder(path) is None
        fcntl.flock(file, fcntl.LOCK_EX)
        assert lock_holder(path) == os.getpid()
    assert lock_holder(path) is None
    assert lock_holder(tmp_path / "none") is None
