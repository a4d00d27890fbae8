"""Pieces of work for jobs: in a module of their own, for jobs must be able to import it."""

import os
import signal
import time

from industnerf.errors import BadPart


def write(path):
    path.write_text("done")


def refuse():
    raise BadPart("not closed")


def kill_own_job():
    """What the kernel does to a job that has no memory left."""
    os.kill(os.getppid(), signal.SIGKILL)
    time.sleep(600)


def hang(mark):
    """Leave `mark` with the job's number in it, and never end."""
    job = os.environ["SLURM_ARRAY_JOB_ID"], os.environ["SLURM_ARRAY_TASK_ID"]
    mark.with_suffix(".draft").write_text("_".join(job))
    mark.with_suffix(".draft").rename(mark)
    time.sleep(600)


def write_own_gpu(own_file, other_file):
    """Leave which GPU the job was given in `own_file`; wait until `other_file` is there."""
    own_file.with_suffix(".draft").write_text(os.environ["CUDA_VISIBLE_DEVICES"])
    own_file.with_suffix(".draft").rename(own_file)
    while not other_file.exists():
        time.sleep(0.1)


def count(target, *, log):
    """Leave a line in `log` for every call."""
    with log.open("a") as file:
        file.write("called\n")
    (target / "result").write_text("counted")


def resume(target, *, scratch, mark):
    """Hang the first time; the second time go on from the note of the first."""
    scratch.mkdir(parents=True, exist_ok=True)
    note = scratch / "note"
    if not note.exists():
        note.write_text("half")
        hang(mark)
    (target / "result").write_text(f"{note.read_text()}, {os.environ['SLURM_RESTART_COUNT']}")
