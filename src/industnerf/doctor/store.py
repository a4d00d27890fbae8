"""Results in the store: does every file hold what the manifest says.

A run compares names, sizes and times; here every byte is read.
"""

import os
import shlex
import stat
import time
from collections.abc import Iterator
from pathlib import Path

from industnerf.doctor.findings import Finding
from industnerf.doctor.project_paths import ProjectPaths
from industnerf.manifest import FILE, find_damage
from industnerf.store import KEY_PATTERN


def check(paths: ProjectPaths) -> list[Finding]:
    """One finding a damaged result, and one of all that no run uses.

    What has no key is not the store's, and left alone.
    """
    entries = sorted(path for path in paths.store.glob("*/*") if KEY_PATTERN.fullmatch(path.name))
    older = [entry for entry in entries if not (entry / FILE).exists()]
    findings = [
        finding
        for entry in entries
        if entry not in older
        for finding in _entry_findings(paths, entry)
    ]
    damaged = sorted(paths.store.glob("*/.damaged-*"))
    return [
        *findings,
        *_unused(paths, older, f"results have no {FILE}: an older version made them"),
        *_unused(paths, damaged, "results were found damaged and set aside"),
    ]


def _entry_findings(paths: ProjectPaths, entry: Path) -> Iterator[Finding]:
    if damage := find_damage(entry, read_all=True):
        aside = entry.with_name(f".damaged-{entry.name}-{time.time_ns()}")
        yield Finding(
            entry, damage + _rerun_hint(paths, entry), f"mv {paths.shell_words(entry, aside)}"
        )
        return
    files = list(_files(entry / "out"))
    writable = [(path, status) for path, status in files if status.st_mode & 0o222]
    if writable:
        path, status = writable[0]
        first = f"{path.name} ({stat.filemode(status.st_mode)})"
        message = f"{len(writable)} of {len(files)} files can be written to, such as {first}"
        out = paths.shell_words(entry / "out")
        yield Finding(entry, message, f"find {out} -type f -exec chmod a-w {{}} +")


def _unused(paths: ProjectPaths, folders: list[Path], what: str) -> list[Finding]:
    """At most one finding, which is worth knowing only: nothing is wrong with what is used."""
    if not folders:
        return []
    first = paths.shell_words(folders[0])
    return [Finding(paths.store, f"{len(folders)} {what}; no run uses them, such as {first}")]


def _rerun_hint(paths: ProjectPaths, entry: Path) -> str:
    """What makes the result anew once it is gone: DVC would not, for its own outputs are whole."""
    from industnerf.stage import stage_of_output  # late: it takes NumPy

    store = f"INDUSTNERF_STORE={shlex.quote(str(paths.store))}"
    commands = [
        f"`(cd {paths.shell_words(project.folder)} && {store} dvc repro -f -s "
        f"{stage_of_output(index.parent)})`"
        for project in paths.projects()
        for pattern in ("data/*/index.json", "data/*/*/index.json")
        for index in sorted(project.folder.glob(pattern))
        if entry.name in index.read_text(encoding="utf-8", errors="replace")
    ]
    return "".join(f"; once it is gone, {command} makes it anew" for command in commands)


def _files(out: Path) -> Iterator[tuple[Path, os.stat_result]]:
    for folder, _, names in os.walk(out):
        for path in (Path(folder, name) for name in names):
            yield path, path.stat()
