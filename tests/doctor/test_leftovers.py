"""What killed processes leave in the store and in the cache."""

import os
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest

from industnerf.doctor.leftovers import HOUR, MONTH
from industnerf.store import Cost, Store
from tests.doctor.conftest import WorkingCopy

DIE = """
import os, signal, sys
from pathlib import Path
from industnerf.store import Store

def make(out):
    (out / "half").write_bytes(bytes(2_500_000))
    os.kill(os.getpid(), signal.SIGKILL)

Store(Path(sys.argv[1])).put("views", "k", make)
"""


def age(folder: Path, seconds: float) -> None:
    """Let everything in `folder` look as if nobody had touched it for so long."""
    then = time.time() - seconds
    for path in [*folder.rglob("*"), folder]:
        os.utime(path, (then, then))


@pytest.fixture
def draft(plain: WorkingCopy) -> Path:
    """What a process left that was killed while it made a result."""
    subprocess.run([sys.executable, "-c", DIE, str(plain.places.store)], check=False)
    (found,) = plain.places.store.glob("views/.draft-k-*")
    return found


def test_the_draft_of_a_killed_process_is_found_and_removed(plain: WorkingCopy, draft: Path):
    age(draft, 2 * HOUR)
    (finding,) = plain.find("leftovers")
    assert finding.what == "1 unfinished results of dead processes, 2.5 MB"
    plain.mend("leftovers")
    assert not draft.exists()


def test_a_fresh_draft_may_be_that_of_another_machine(plain: WorkingCopy, draft: Path):
    age(draft, 0.5 * HOUR)
    assert plain.find("leftovers") == []


def test_a_process_that_lives_keeps_its_draft(plain: WorkingCopy, draft: Path):
    mine = draft.rename(draft.with_name(f".draft-k-{socket.gethostname()}-{os.getpid()}"))
    age(mine, 2 * HOUR)
    assert plain.find("leftovers") == []


@pytest.mark.parametrize(("seconds", "found"), [(2 * HOUR, False), (2 * MONTH, True)])
def test_what_another_machine_began_may_take_it_days(
    plain: WorkingCopy, draft: Path, seconds: float, found: bool
):
    age(draft.rename(draft.with_name(".draft-k-an-other-host-1")), seconds)
    assert bool(plain.find("leftovers")) == found


@pytest.mark.parametrize(
    ("finished", "seconds", "found"),
    [
        (True, 2 * HOUR, True),
        (True, 0.5 * HOUR, False),
        (False, 2 * HOUR, False),
        (False, 2 * MONTH, True),
    ],
)
def test_what_a_result_resumes_from_is_kept_while_it_may(
    plain: WorkingCopy, finished: bool, seconds: float, found: bool
):
    store = Store(plain.places.store)
    if finished:
        store.put("train", "k", lambda out: _written(out / "net"))
    scratch = store.scratch("train", "k")
    scratch.mkdir(parents=True)
    (scratch / "state").write_text("half")
    age(scratch, seconds)
    assert bool(plain.find("leftovers")) == found
    if found:
        plain.mend("leftovers")
        assert not scratch.exists()
        assert store.has("train", "k") == finished


def _written(path: Path) -> Cost:
    path.write_text("whole")
    return Cost(1.0, 1.0, "cpu")


def test_a_half_written_file_of_the_cache_is_found_and_removed(copy: WorkingCopy):
    folder = next(copy.folder.glob(".dvc/cache/files/md5/*"))
    torn = folder / ".Vh3kfdkHzvQ5.tmp"
    torn.write_bytes(bytes(1_000_000))
    assert copy.find("leftovers") == []  # it may still be written
    age(copy.folder / ".dvc/cache", 2 * HOUR)  # whole ones may be as old
    (finding,) = copy.find("leftovers")
    assert finding.what == "1 half written files, 1.0 MB"
    copy.mend("leftovers")
    assert not torn.exists()
    assert copy.find("cache") == []


def test_a_draft_that_becomes_a_result_meanwhile_is_no_fault(
    plain: WorkingCopy, draft: Path, monkeypatch: pytest.MonkeyPatch
):
    age(draft, 2 * HOUR)
    listed = os.scandir

    def and_then_it_is_renamed(folder: str | Path):
        found = listed(folder)
        if Path(folder) == draft:
            draft.rename(draft.with_name("k"))
        return found

    monkeypatch.setattr(os, "scandir", and_then_it_is_renamed)
    assert plain.find("leftovers") == []
