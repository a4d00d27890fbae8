"""How work is dealt out to jobs, and what a job does that starts again."""

import errno
import multiprocessing
import os
import signal
import time
from functools import partial

from hypothesis import given
from hypothesis import strategies as st

from industnerf.errors import BadPart
from industnerf.runner import Outcome
from industnerf.runner.chunk import ARRAY_MOST, ROUNDS, Chunk, chunked
from industnerf.runner.notes import Notes

NUMBERS = st.integers(1, 500)


@given(st.integers(1, 20_000), NUMBERS, st.none() | NUMBERS)
def test_every_piece_is_in_one_job_and_jobs_are_alike(pieces, at_a_time, least):
    dealt = chunked(range(pieces), at_a_time, least)
    assert sorted(piece for each in dealt for piece in each) == list(range(pieces))
    sizes = {len(each) for each in dealt}
    assert max(sizes) - min(sizes) <= 1
    assert len(dealt) <= ARRAY_MOST


@given(st.integers(1, 20_000), NUMBERS)
def test_of_itself_every_job_that_may_run_has_some_to_do_after(pieces, at_a_time):
    jobs = len(chunked(range(pieces), at_a_time))
    assert jobs == min(pieces, ROUNDS * at_a_time, ARRAY_MOST)


@given(st.integers(1, 20_000), NUMBERS)
def test_a_job_has_the_least_size_and_there_are_as_many_jobs_as_that_allows(pieces, least):
    dealt = chunked(range(pieces), 64, least)
    assert min(len(each) for each in dealt) >= min(least, pieces)
    assert len(dealt) == ARRAY_MOST or pieces < least * (len(dealt) + 1)


def add(path):
    with path.open("a") as file:
        file.write("x")


def refuse():
    raise BadPart("not closed")


def fill_disk():
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def test_a_job_notes_that_a_disk_was_full_and_not_the_piece_at_fault(tmp_path):
    Chunk(((4, fill_disk),), Notes(tmp_path), workers=1, limit_s=60.0, memory_mb=None)()
    noted = Notes(tmp_path).outcome(4)
    assert (noted.lost, "No space left on device" in noted.error) == (True, True)


def test_a_job_notes_how_each_piece_ended_and_does_none_twice(tmp_path):
    notes = Notes(tmp_path / "notes")
    notes.folder.mkdir()
    works = ((3, partial(add, tmp_path / "a")), (5, refuse), (8, partial(add, tmp_path / "b")))
    chunk = Chunk(works, notes, workers=1, limit_s=60.0, memory_mb=None)
    notes.write(Outcome(3, None))  # as if an earlier life of the job had ended it
    chunk()
    chunk()
    assert notes.ended() == {3, 5, 8}
    assert notes.begun() == {5, 8}
    assert notes.outcome(5) == Outcome(5, "not closed")
    assert notes.outcome(8) == Outcome(8, None)
    assert not (tmp_path / "a").exists()
    assert (tmp_path / "b").read_text() == "x"


def end_the_job():
    """As `scancel --signal=KILL` ends all processes of a job: a piece first, its parent after."""
    job = os.getppid()
    if not os.fork():
        os.closerange(3, 256)  # else the parent waits for this process, which holds its pipe too
        time.sleep(0.3)
        os.kill(job, signal.SIGKILL)
        os._exit(0)
    os.kill(os.getpid(), signal.SIGKILL)


def test_a_job_that_is_killed_does_not_say_that_its_piece_crashed(tmp_path):
    """Of that piece nothing is known, and the next one is not begun."""
    notes = Notes(tmp_path / "notes")
    notes.folder.mkdir()
    works = ((0, end_the_job), (1, partial(add, tmp_path / "a")))
    chunk = Chunk(works, notes, workers=1, limit_s=60.0, memory_mb=None)
    job = multiprocessing.get_context("spawn").Process(target=chunk)
    job.start()
    job.join()
    assert job.exitcode == -signal.SIGKILL
    assert notes.ended() == set()
    assert notes.begun() == {0}
