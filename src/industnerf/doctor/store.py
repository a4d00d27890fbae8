"""Results in the store.  They are whole and read-only when they come in; something may spoil them.

Files are linked, not copied, to where they are used: one that can be written to can be changed in
all places at once.
"""

import json
import os
import shlex
import stat
from collections.abc import Iterator
from pathlib import Path

from industnerf.doctor.findings import Finding
from industnerf.doctor.project_paths import ProjectPaths
from industnerf.store import KEY_PATTERN, Cost

# the last bytes of a whole file: PNG's end chunk, and where the directory of a zip begins to end
END_MARKERS = {".png": (12, b"IEND"), ".npz": (22, b"PK\x05\x06")}


def check(paths: ProjectPaths) -> list[Finding]:
    """One finding a spoilt result.  What has no key is not the store's, and left alone."""
    entries = sorted(path for path in paths.store.glob("*/*") if KEY_PATTERN.fullmatch(path.name))
    return [finding for entry in entries for finding in _entry_findings(paths, entry)]


def _entry_findings(paths: ProjectPaths, entry: Path) -> Iterator[Finding]:
    files = list(_files(entry / "out"))
    if problem := _find_truncation(entry, files):
        yield Finding(
            entry, problem + _rerun_hint(paths, entry), f"rm -rf {paths.shell_words(entry)}"
        )
        return
    writable = [(path, status) for path, status in files if status.st_mode & 0o222]
    if writable:
        path, status = writable[0]
        first = f"{path.name} ({stat.filemode(status.st_mode)})"
        message = f"{len(writable)} of {len(files)} files can be written to, such as {first}"
        out = paths.shell_words(entry / "out")
        yield Finding(entry, message, f"find {out} -type f -exec chmod a-w {{}} +")


def _find_truncation(entry: Path, files: list[tuple[Path, os.stat_result]]) -> str:
    """What is missing of the result, of which these are the files; empty if nothing is."""
    if not files:
        return "has nothing in out/: no run can finish or use it"
    if empty := [path for path, status in files if status.st_size == 0]:
        return f"{len(empty)} of {len(files)} files are empty, such as {empty[0].name}"
    if truncated := [path for path, _ in files if is_truncated(path)]:
        return f"{len(truncated)} of {len(files)} files are cut short, such as {truncated[0].name}"
    return _find_cost_problem(entry / "cost.json")


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


def is_truncated(path: Path) -> bool:
    """Whether a file is not whole, as far as its kind tells; of other kinds nothing is known."""
    if path.suffix == ".json":
        return not _is_json(path)
    if path.suffix not in END_MARKERS:
        return False
    length, mark = END_MARKERS[path.suffix]
    with path.open("rb") as file:
        file.seek(-min(length, path.stat().st_size), os.SEEK_END)
        return mark not in file.read()


def _is_json(path: Path) -> bool:
    try:
        json.loads(path.read_text(encoding="utf-8"))
    except ValueError:
        return False
    return True


def _find_cost_problem(path: Path) -> str:
    try:
        Cost(**json.loads(path.read_text(encoding="utf-8")))
    except FileNotFoundError:
        return "has no cost.json: its time and memory are missing from every table"
    except (ValueError, TypeError) as error:
        return f"cost.json is torn ({error}): every run that meets it stops"
    return ""
