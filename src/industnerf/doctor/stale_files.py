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
from industnerf.doctor.processes import is_alive
from industnerf.doctor.project_paths import ProjectPaths

HOUR, MONTH = 3600.0, 30 * 24 * 3600.0  # s


def check(paths: ProjectPaths) -> list[Finding]:
    """One finding a kind of leftover and folder."""
    return [
        *_findings(
            paths, paths.store, "unfinished results of dead processes", _drafts(paths.store)
        ),
        *_findings(
            paths, paths.store, "folders that nothing resumes from", _resume_folders(paths.store)
        ),
        *(
            finding
            for project in paths.projects()
            for finding in _findings(
                paths, project.cache, "half written files", _partial_files(project.cache)
            )
        ),
    ]


def _findings(paths: ProjectPaths, folder: Path, kind: str, stale: Iterator[Path]) -> list[Finding]:
    stale_paths = sorted(stale)
    size = sum(
        status.st_size
        for path in stale_paths
        for status in _file_stats(path)
        if S_ISREG(status.st_mode)
    )
    message = f"{len(stale_paths)} {kind}, {megabytes(size)}"
    return (
        [Finding(folder, message, f"rm -rf {paths.shell_words(*stale_paths)}")]
        if stale_paths
        else []
    )


def _drafts(store: Path) -> Iterator[Path]:
    for path in store.glob("*/.draft-*"):
        host, _, pid = path.name.split("-", 2)[-1].rpartition("-")
        is_dead = host == socket.gethostname() and pid.isdigit() and not is_alive(int(pid))
        if _age(path) > (HOUR if is_dead else MONTH):
            yield path


def _resume_folders(store: Path) -> Iterator[Path]:
    for path in store.glob("*/.resume-*"):
        is_finished = path.with_name(path.name.removeprefix(".resume-")).exists()
        if _age(path) > (HOUR if is_finished else MONTH):
            yield path


def _partial_files(cache: Path) -> Iterator[Path]:
    for path in cache.glob("**/*"):
        if path.is_file() and not OBJECT.fullmatch(path.name) and _age(path) > HOUR:
            yield path


def _file_stats(path: Path) -> Iterator[os.stat_result]:
    """Of `path` and all in it; a worker may finish meanwhile, and what it had is then gone."""
    inside = (Path(folder) / name for folder, _, names in os.walk(path) for name in [".", *names])
    for entry in [path, *inside]:
        with suppress(FileNotFoundError):
            yield entry.stat()


def _age(path: Path) -> float:
    """Seconds since anything in `path` was changed; 0 if it is gone."""
    now = time.time()
    return now - max((status.st_mtime for status in _file_stats(path)), default=now)
