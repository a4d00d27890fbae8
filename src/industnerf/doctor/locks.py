"""Locks.  The kernel drops those of dead processes; two kinds of trouble remain.

A process that is stopped (Ctrl-Z) keeps its locks and everybody waits.  DVC's rwlock is a file
with process numbers: torn, or with a number that another process has by now, it blocks for ever.
"""

import json
import time
from pathlib import Path

from industnerf.doctor.findings import Finding
from industnerf.doctor.places import Places
from industnerf.doctor.processes import command, holder, is_alive, state

LOOKS, LOOK_S = 10, 0.1  # DVC empties the file before it writes it anew


def find(places: Places) -> list[Finding]:
    """Locks that are held; those of processes at work are only told of."""
    folders = [project.folder / ".dvc" / "tmp" for project in places.projects()]
    files = [folder / name for folder in folders for name in ("lock", "rwlock.lock")]
    files.append(places.database.with_name("mlflow.db.lock"))
    found = [_held(path, pid) for path in files if (pid := holder(path)) is not None]
    return found + [finding for folder in folders for finding in _rwlock(places, folder / "rwlock")]


def _held(path: Path, pid: int) -> Finding:
    what = f"held by process {pid} ({command(pid)})"
    if state(pid) == "T":
        return Finding(path, f"{what}, which is stopped: others wait for it", f"kill -CONT {pid}")
    return Finding(path, f"{what}, which is at work")


def _rwlock(places: Places, path: Path) -> list[Finding]:
    remove = f"rm {places.words(path)}"
    entries = _read(path)
    if entries is None:
        size = path.stat().st_size
        return [Finding(path, f"torn ({size} bytes, not DVC's JSON): DVC stops at it", remove)]
    if any(is_alive(pid) and _is_dvc(pid) for pid, _ in entries):
        remove = ""  # the file is theirs too
    return [_entry(path, pid, by, remove) for pid, by in sorted(entries)]


def _is_dvc(pid: int) -> bool:
    """Whether that process is DVC, by the names of its first words."""
    return any(Path(word).name == "dvc" for word in command(pid).split()[:4])


def _read(path: Path) -> set[tuple[int, str]] | None:
    """Who is written down; None if the file is torn, and not because DVC is just writing it."""
    for _ in range(LOOKS):
        try:
            return _entries(json.loads(path.read_text(encoding="utf-8")))
        except FileNotFoundError:
            return set()
        except (ValueError, TypeError, AttributeError, KeyError):
            time.sleep(LOOK_S)
    return None


def _entries(content: dict) -> set[tuple[int, str]]:
    """Process and command of everybody who is written down as a reader or writer."""
    writers = list(content.get("write", {}).values())
    readers = [one for many in content.get("read", {}).values() for one in many]
    return {(int(one["pid"]), str(one["cmd"])) for one in [*writers, *readers]}


def _entry(path: Path, pid: int, by: str, remove: str) -> Finding:
    if not is_alive(pid):
        return Finding(path, f"names process {pid} ({by}), which is dead: DVC passes over it")
    if not _is_dvc(pid):
        what = f"names process {pid} as {by}, but that is now {command(pid)}: DVC waits in vain"
        if not remove:
            what += "; ask again when the DVC that is at work has ended"
        return Finding(path, what, remove, wrong=True)
    if state(pid) == "T":
        return Finding(path, f"process {pid} ({by}) is stopped: others wait", f"kill -CONT {pid}")
    return Finding(path, f"process {pid} ({by}) is at work")
