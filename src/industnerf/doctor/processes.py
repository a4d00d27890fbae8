"""What /proc says of processes and of the file locks they hold.  Only Linux has it."""

import os
from pathlib import Path

PROC = Path("/proc")


def is_alive(pid: int) -> bool:
    """Whether there is such a process on this machine; one that only waits to be reaped is none."""
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        return True
    return process_state(pid) != "Z"


def process_state(pid: int) -> str:
    """`R`, `S`, `T` for stopped, ... as Linux calls it; empty if unknown."""
    try:
        return (PROC / str(pid) / "stat").read_text().rpartition(")")[2].split()[0]
    except (OSError, IndexError):
        return ""


def command_line(pid: int) -> str:
    """The command line of the process; empty if unknown."""
    try:
        arguments = (PROC / str(pid) / "cmdline").read_bytes().split(b"\0")
    except OSError:
        return ""
    return b" ".join(arguments).decode(errors="replace").strip()


def lock_holder(path: Path) -> int | None:
    """The process that holds a lock on the file `path`, without trying to take it."""
    try:
        entry_texts = (PROC / "locks").read_text().splitlines()
        file_stat = path.stat()
    except OSError:
        return None
    entries = [line.split() for line in entry_texts if "->" not in line]
    pids = [
        int(fields[4])
        for fields in entries
        if fields[5].rpartition(":")[2] == str(file_stat.st_ino)
    ]
    return next((pid for pid in pids if pid > 0 and _may_have_open(pid, file_stat)), None)


def _may_have_open(pid: int, file_stat: os.stat_result) -> bool:
    """Whether the process has that file open, not one of the same number on another disk.

    One that is another user's does not tell.
    """
    try:
        files = list((PROC / str(pid) / "fd").iterdir())
    except PermissionError:
        return True
    except OSError:
        return False
    return any(_is_same(file, file_stat) for file in files)


def _is_same(file: Path, file_stat: os.stat_result) -> bool:
    try:
        return os.path.samestat(file.stat(), file_stat)
    except OSError:
        return False
