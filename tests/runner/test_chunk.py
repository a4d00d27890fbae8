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
from industnerf.runner import WorkResult
from industnerf.runner.chunk import JOBS_PER_SLOT, MAX_ARRAY_JOBS, Chunk, split_into_chunks
from industnerf.runner.job_status import JobStatus

NUMBERS = st.integers(1, 500)


@given(st.integers(1, 20_000), NUMBERS, st.none() | NUMBERS)
def test_every_piece_is_in_one_job_and_jobs_are_alike(count, parallel_jobs, min_size):
    chunks = split_into_chunks(range(count), parallel_jobs, min_size)
    assert sorted(index for chunk in chunks for index in chunk) == list(range(count))
    sizes = {len(chunk) for chunk in chunks}
    assert max(sizes) - min(sizes) <= 1
    assert len(chunks) <= MAX_ARRAY_JOBS


@given(st.integers(1, 20_000), NUMBERS)
def test_of_itself_every_job_that_may_run_has_some_to_do_after(count, parallel_jobs):
    jobs = len(split_into_chunks(range(count), parallel_jobs))
    assert jobs == min(count, JOBS_PER_SLOT * parallel_jobs, MAX_ARRAY_JOBS)


@given(st.integers(1, 20_000), NUMBERS)
def test_a_job_has_the_least_size_and_there_are_as_many_jobs_as_that_allows(count, min_size):
    chunks = split_into_chunks(range(count), 64, min_size)
    assert min(len(chunk) for chunk in chunks) >= min(min_size, count)
    assert len(chunks) == MAX_ARRAY_JOBS or count < min_size * (len(chunks) + 1)


def add(path):
    with path.open("a") as file:
        file.write("x")


def refuse():
    raise BadPart("not closed")


def fill_disk():
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def test_a_job_notes_that_a_disk_was_full_and_not_the_piece_at_fault(tmp_path):
    Chunk(((4, fill_disk),), JobStatus(tmp_path), workers=1, limit_s=60.0, memory_mb=None)()
    result = JobStatus(tmp_path).result(4)
    assert (result.lost, "No space left on device" in result.error) == (True, True)


def test_a_job_notes_how_each_piece_ended_and_does_none_twice(tmp_path):
    status = JobStatus(tmp_path / "notes")
    status.folder.mkdir()
    work_items = ((3, partial(add, tmp_path / "a")), (5, refuse), (8, partial(add, tmp_path / "b")))
    chunk = Chunk(work_items, status, workers=1, limit_s=60.0, memory_mb=None)
    status.write(WorkResult(3, None))  # as if an earlier life of the job had ended it
    chunk()
    chunk()
    assert status.finished() == {3, 5, 8}
    assert status.started() == {5, 8}
    assert status.result(5) == WorkResult(5, "not closed")
    assert status.result(8) == WorkResult(8, None)
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
    status = JobStatus(tmp_path / "notes")
    status.folder.mkdir()
    work_items = ((0, end_the_job), (1, partial(add, tmp_path / "a")))
    chunk = Chunk(work_items, status, workers=1, limit_s=60.0, memory_mb=None)
    job = multiprocessing.get_context("spawn").Process(target=chunk)
    job.start()
    job.join()
    assert job.exitcode == -signal.SIGKILL
    assert status.finished() == set()
    assert status.started() == {0}
