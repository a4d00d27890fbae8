"""What killed processes left behind.  It harms nobody, but takes room.

What was touched within the last hour is left alone.  A store may be shared with other machines,
whose processes cannot be seen from here: what one of them began, and what a result resumes from, is
left alone for a month.
"""

import os
import socket
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from stat import S_ISREG

from industnerf.doctor.cache import OBJECT
from industnerf.doctor.findings import Finding, megabytes
from industnerf.doctor.places import Places
from industnerf.doctor.processes import is_alive

HOUR, MONTH = 3600.0, 30 * 24 * 3600.0  # s


def find(places: Places) -> list[Finding]:
    """One finding a kind of leftover and folder."""
    return [
        *_of(places, places.store, "unfinished results of dead processes", _drafts(places.store)),
        *_of(places, places.store, "folders that nothing resumes from", _scratch(places.store)),
        *(
            finding
            for project in places.projects()
            for finding in _of(places, project.cache, "half written files", _torn(project.cache))
        ),
    ]


def _of(places: Places, where: Path, kind: str, paths: Iterator[Path]) -> list[Finding]:
    found = sorted(paths)
    size = sum(facts.st_size for path in found for facts in _facts(path) if S_ISREG(facts.st_mode))
    what = f"{len(found)} {kind}, {megabytes(size)}"
    return [Finding(where, what, f"rm -rf {places.words(*found)}")] if found else []


def _drafts(store: Path) -> Iterator[Path]:
    for path in store.glob("*/.draft-*"):
        host, _, pid = path.name.split("-", 2)[-1].rpartition("-")
        dead = host == socket.gethostname() and pid.isdigit() and not is_alive(int(pid))
        if _age(path) > (HOUR if dead else MONTH):
            yield path


def _scratch(store: Path) -> Iterator[Path]:
    for path in store.glob("*/.resume-*"):
        finished = path.with_name(path.name.removeprefix(".resume-")).exists()
        if _age(path) > (HOUR if finished else MONTH):
            yield path


def _torn(cache: Path) -> Iterator[Path]:
    for path in cache.glob("**/*"):
        if path.is_file() and not OBJECT.fullmatch(path.name) and _age(path) > HOUR:
            yield path


def _facts(path: Path) -> Iterator[os.stat_result]:
    """Of `path` and all in it; a worker may finish meanwhile, and what it had is then gone."""
    inside = (Path(at) / name for at, _, names in os.walk(path) for name in [".", *names])
    for each in [path, *inside]:
        with suppress(FileNotFoundError):
            yield each.stat()


def _age(path: Path) -> float:
    """Seconds since anything in `path` was changed; 0 if it is gone."""
    now = time.time()
    return now - max((facts.st_mtime for facts in _facts(path)), default=now)
