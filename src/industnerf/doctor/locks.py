"""Locks.  The kernel drops those of dead processes; two kinds of trouble remain.

A process that is stopped (Ctrl-Z) keeps its locks and everybody waits.  DVC's rwlock is a file
with process numbers: torn, or with a number that another process has by now, it blocks for ever.
"""

import json
import time
from pathlib import Path

from industnerf.doctor.findings import Finding
from industnerf.doctor.processes import command_line, is_alive, lock_holder, process_state
from industnerf.doctor.project_paths import ProjectPaths

READ_ATTEMPTS, READ_INTERVAL_S = 10, 0.1  # DVC empties the file before it writes it anew


def check(paths: ProjectPaths) -> list[Finding]:
    """Locks that are held; those of processes at work are only told of."""
    folders = [project.folder / ".dvc" / "tmp" for project in paths.projects()]
    files = [folder / name for folder in folders for name in ("lock", "rwlock.lock")]
    files.append(paths.database.with_name("mlflow.db.lock"))
    findings = [_held_lock(path, pid) for path in files if (pid := lock_holder(path)) is not None]
    return findings + [
        finding for folder in folders for finding in _check_rwlock(paths, folder / "rwlock")
    ]


def _held_lock(path: Path, pid: int) -> Finding:
    message = f"held by process {pid} ({command_line(pid)})"
    if process_state(pid) == "T":
        return Finding(
            path, f"{message}, which is stopped: others wait for it", f"kill -CONT {pid}"
        )
    return Finding(path, f"{message}, which is at work")


def _check_rwlock(paths: ProjectPaths, path: Path) -> list[Finding]:
    remove = f"rm {paths.shell_words(path)}"
    entries = _read_rwlock(path)
    if entries is None:
        size = path.stat().st_size
        return [Finding(path, f"torn ({size} bytes, not DVC's JSON): DVC stops at it", remove)]
    if any(is_alive(pid) and _is_dvc(pid) for pid, _ in entries):
        remove = ""  # the file is theirs too
    return [
        _rwlock_finding(path, pid, command_name, remove) for pid, command_name in sorted(entries)
    ]


def _is_dvc(pid: int) -> bool:
    """Whether that process is DVC, by the names of its first words."""
    return any(Path(word).name == "dvc" for word in command_line(pid).split()[:4])


def _read_rwlock(path: Path) -> set[tuple[int, str]] | None:
    """Who is written down; None if the file is torn, and not because DVC is just writing it."""
    for _ in range(READ_ATTEMPTS):
        try:
            return _lock_holders(json.loads(path.read_text(encoding="utf-8")))
        except FileNotFoundError:
            return set()
        except (ValueError, TypeError, AttributeError, KeyError):
            time.sleep(READ_INTERVAL_S)
    return None


def _lock_holders(content: dict) -> set[tuple[int, str]]:
    """Process and command of everybody who is written down as a reader or writer."""
    writers = list(content.get("write", {}).values())
    readers = [entry for entries in content.get("read", {}).values() for entry in entries]
    return {(int(entry["pid"]), str(entry["cmd"])) for entry in [*writers, *readers]}


def _rwlock_finding(path: Path, pid: int, command_name: str, remove: str) -> Finding:
    if not is_alive(pid):
        return Finding(
            path, f"names process {pid} ({command_name}), which is dead: DVC passes over it"
        )
    if not _is_dvc(pid):
        message = f"names process {pid} as {command_name}, but that is now {command_line(pid)}: "
        message += "DVC waits in vain"
        if not remove:
            message += "; ask again when the DVC that is at work has ended"
        return Finding(path, message, remove, is_unfixable=True)
    if process_state(pid) == "T":
        return Finding(
            path, f"process {pid} ({command_name}) is stopped: others wait", f"kill -CONT {pid}"
        )
    return Finding(path, f"process {pid} ({command_name}) is at work")
