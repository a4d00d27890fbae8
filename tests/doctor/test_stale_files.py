"""What killed processes leave in the store and in the cache."""

import os
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest

from industnerf.doctor.stale_files import HOUR, MONTH
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
def dead_draft(bare_copy: WorkingCopy) -> Path:
    """What a process left that was killed while it made a result."""
    subprocess.run([sys.executable, "-c", DIE, str(bare_copy.paths.store)], check=False)
    (drafts,) = bare_copy.paths.store.glob("views/.draft-k-*")
    return drafts


def test_the_draft_of_a_killed_process_is_found_and_removed(
    bare_copy: WorkingCopy, dead_draft: Path
):
    age(dead_draft, 2 * HOUR)
    (finding,) = bare_copy.check("stale_files")
    assert finding.message == "1 unfinished results of dead processes, 2.5 MB"
    bare_copy.fix("stale_files")
    assert not dead_draft.exists()


def test_a_fresh_draft_may_be_that_of_another_machine(bare_copy: WorkingCopy, dead_draft: Path):
    age(dead_draft, 0.5 * HOUR)
    assert bare_copy.check("stale_files") == []


def test_a_process_that_lives_keeps_its_draft(bare_copy: WorkingCopy, dead_draft: Path):
    own_draft = dead_draft.rename(
        dead_draft.with_name(f".draft-k-{socket.gethostname()}-{os.getpid()}")
    )
    age(own_draft, 2 * HOUR)
    assert bare_copy.check("stale_files") == []


@pytest.mark.parametrize(("seconds", "is_found"), [(2 * HOUR, False), (2 * MONTH, True)])
def test_what_another_machine_began_may_take_it_days(
    bare_copy: WorkingCopy, dead_draft: Path, seconds: float, is_found: bool
):
    age(dead_draft.rename(dead_draft.with_name(".draft-k-an-other-host-1")), seconds)
    assert bool(bare_copy.check("stale_files")) == is_found


@pytest.mark.parametrize(
    ("finished", "seconds", "is_found"),
    [
        (True, 2 * HOUR, True),
        (True, 0.5 * HOUR, False),
        (False, 2 * HOUR, False),
        (False, 2 * MONTH, True),
    ],
)
def test_what_a_result_resumes_from_is_kept_while_it_may(
    bare_copy: WorkingCopy, finished: bool, seconds: float, is_found: bool
):
    store = Store(bare_copy.paths.store)
    if finished:
        store.put("train", "k", lambda out: _written(out / "net"))
    resume_folder = store.scratch_dir("train", "k")
    resume_folder.mkdir(parents=True)
    (resume_folder / "state").write_text("half")
    age(resume_folder, seconds)
    assert bool(bare_copy.check("stale_files")) == is_found
    if is_found:
        bare_copy.fix("stale_files")
        assert not resume_folder.exists()
        assert store.has("train", "k") == finished


def _written(path: Path) -> Cost:
    path.write_text("whole")
    return Cost(1.0, 1.0, "cpu")


def test_a_half_written_file_of_the_cache_is_found_and_removed(dvc_copy: WorkingCopy):
    folder = next(dvc_copy.folder.glob(".dvc/cache/files/md5/*"))
    partial_file = folder / ".Vh3kfdkHzvQ5.tmp"
    partial_file.write_bytes(bytes(1_000_000))
    assert dvc_copy.check("stale_files") == []  # it may still be written
    age(dvc_copy.folder / ".dvc/cache", 2 * HOUR)  # whole ones may be as old
    (finding,) = dvc_copy.check("stale_files")
    assert finding.message == "1 half written files, 1.0 MB"
    dvc_copy.fix("stale_files")
    assert not partial_file.exists()
    assert dvc_copy.check("cache") == []


def test_a_draft_that_becomes_a_result_meanwhile_is_no_fault(
    bare_copy: WorkingCopy, dead_draft: Path, monkeypatch: pytest.MonkeyPatch
):
    age(dead_draft, 2 * HOUR)
    listed_folders = os.scandir

    def and_then_it_is_renamed(folder: str | Path):
        findings = listed_folders(folder)
        if Path(folder) == dead_draft:
            dead_draft.rename(dead_draft.with_name("k"))
        return findings

    monkeypatch.setattr(os, "scandir", and_then_it_is_renamed)
    assert bare_copy.check("stale_files") == []
