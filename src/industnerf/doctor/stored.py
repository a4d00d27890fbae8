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
from industnerf.doctor.places import Places
from industnerf.store import KEY, Cost

# the last bytes of a whole file: PNG's end chunk, and where the directory of a zip begins to end
ENDS = {".png": (12, b"IEND"), ".npz": (22, b"PK\x05\x06")}


def find(places: Places) -> list[Finding]:
    """One finding a spoilt result.  What has no key is not the store's, and left alone."""
    entries = sorted(path for path in places.store.glob("*/*") if KEY.fullmatch(path.name))
    return [finding for entry in entries for finding in _faults(places, entry)]


def _faults(places: Places, entry: Path) -> Iterator[Finding]:
    files = list(_files(entry / "out"))
    if torn := _torn(entry, files):
        yield Finding(entry, torn + _again(places, entry), f"rm -rf {places.words(entry)}")
        return
    writable = [(path, status) for path, status in files if status.st_mode & 0o222]
    if writable:
        path, status = writable[0]
        first = f"{path.name} ({stat.filemode(status.st_mode)})"
        what = f"{len(writable)} of {len(files)} files can be written to, such as {first}"
        out = places.words(entry / "out")
        yield Finding(entry, what, f"find {out} -type f -exec chmod a-w {{}} +")


def _torn(entry: Path, files: list[tuple[Path, os.stat_result]]) -> str:
    """What is missing of the result, of which these are the files; empty if nothing is."""
    if not files:
        return "has nothing in out/: no run can finish or use it"
    if empty := [path for path, status in files if status.st_size == 0]:
        return f"{len(empty)} of {len(files)} files are empty, such as {empty[0].name}"
    if cut := [path for path, _ in files if is_cut_short(path)]:
        return f"{len(cut)} of {len(files)} files are cut short, such as {cut[0].name}"
    return _cost_fault(entry / "cost.json")


def _again(places: Places, entry: Path) -> str:
    """What makes the result anew once it is gone: DVC would not, for its own outputs are whole."""
    from industnerf.stage import stage_of  # late: it brings NumPy, and most have nothing torn

    store = f"INDUSTNERF_STORE={shlex.quote(str(places.store))}"
    commands = [
        f"`(cd {places.words(project.folder)} && {store} dvc repro -f -s {stage_of(index.parent)})`"
        for project in places.projects()
        for pattern in ("data/*/index.json", "data/*/*/index.json")
        for index in sorted(project.folder.glob(pattern))
        if entry.name in index.read_text(encoding="utf-8", errors="replace")
    ]
    return "".join(f"; once it is gone, {command} makes it anew" for command in commands)


def _files(out: Path) -> Iterator[tuple[Path, os.stat_result]]:
    for folder, _, names in os.walk(out):
        for path in (Path(folder, name) for name in names):
            yield path, path.stat()


def is_cut_short(path: Path) -> bool:
    """Whether a file is not whole, as far as its kind tells; of other kinds nothing is known."""
    if path.suffix == ".json":
        return not _is_json(path)
    if path.suffix not in ENDS:
        return False
    length, mark = ENDS[path.suffix]
    with path.open("rb") as file:
        file.seek(-min(length, path.stat().st_size), os.SEEK_END)
        return mark not in file.read()


def _is_json(path: Path) -> bool:
    try:
        json.loads(path.read_text(encoding="utf-8"))
    except ValueError:
        return False
    return True


def _cost_fault(path: Path) -> str:
    try:
        Cost(**json.loads(path.read_text(encoding="utf-8")))
    except FileNotFoundError:
        return "has no cost.json: its time and memory are missing from every table"
    except (ValueError, TypeError) as error:
        return f"cost.json is torn ({error}): every run that meets it stops"
    return ""
