"""Results in the store.  They are whole and read-only when they come in; something may spoil them.

Files are linked, not copied, to where they are used: one that can be written to can be changed in
all places at once.
"""

import json
import os
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
    """`rm` is the cure of what is torn: the next run makes the result anew."""
    remove = f"rm -rf {places.words(entry)}"
    files = list(_files(entry / "out"))
    empty = [path for path, status in files if status.st_size == 0]
    cut = [path for path, _ in files if is_cut_short(path)]
    writable = [(path, status) for path, status in files if status.st_mode & 0o222]
    if not files:
        yield Finding(entry, "has nothing in out/: no run can finish or use it", remove)
    elif empty:
        what = f"{len(empty)} of {len(files)} files are empty, such as {empty[0].name}"
        yield Finding(entry, what, remove)
    elif cut:
        what = f"{len(cut)} of {len(files)} files are cut short, such as {cut[0].name}"
        yield Finding(entry, what, remove)
    elif fault := _cost_fault(entry / "cost.json"):
        yield Finding(entry, fault, remove)
    elif writable:
        path, status = writable[0]
        first = f"{path.name} ({stat.filemode(status.st_mode)})"
        what = f"{len(writable)} of {len(files)} files can be written to, such as {first}"
        yield Finding(entry, what, f"chmod -R a-w {places.words(entry / 'out')}")


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
