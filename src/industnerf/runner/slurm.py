"""SLURM: the pieces of work of a stage as one job array, through submitit.

The process that asks (a stage, a sweep) stays on the login node and waits.  Jobs run in its working
directory with its environment.  That folder, the store and the logs must be visible on every node
under the same path.  `allocation.py` lists what can be set.
"""

import math
import shutil
import signal
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from industnerf.errors import BadParams
from industnerf.runner import queue
from industnerf.runner.allocation import (
    WARNING_S,
    Allocation,
    Waiting,
    allocation_from_environment,
    waiting_from_environment,
)
from industnerf.runner.base import Outcome, Work
from industnerf.runner.chunk import Chunk, chunked
from industnerf.runner.notes import Notes
from industnerf.runner.signals import put_off
from industnerf.runner.watch import Watch

PROGRAMS = ("sbatch", "squeue", "scancel", "srun")


def slurm_from_environment() -> "SlurmRunner":
    """The runner that INDUSTNERF_SLURM_* describe; raises BadParams where it cannot work."""
    if find_spec("submitit") is None:
        raise BadParams(
            "INDUSTNERF_RUNNER=submitit needs the package submitit: "
            "pip install -e '.[slurm]' -c constraints.txt (with uv: uv pip install)"
        )
    if absent := [name for name in PROGRAMS if not shutil.which(name)]:
        raise BadParams(
            f"INDUSTNERF_RUNNER=submitit needs {', '.join(absent)} of SLURM, not found here"
        )
    return SlurmRunner(allocation_from_environment(), waiting_from_environment())


@dataclass(frozen=True)
class SlurmRunner:
    """Job arrays; in a job every piece of work has a process of its own."""

    allocation: Allocation
    waiting: Waiting

    def map(
        self, works: Sequence[Work], limit_s: float, memory_mb: int | None = None
    ) -> Iterator[Outcome]:
        _check_time(limit_s, self.allocation.minutes)
        if not works:
            return
        self.waiting.folder.mkdir(parents=True, exist_ok=True)
        folder = Path(tempfile.mkdtemp(prefix="run-", dir=self.waiting.folder))
        notes = Notes(folder / "notes")
        notes.folder.mkdir()
        how = {"workers": self.allocation.cpus, "limit_s": limit_s, "memory_mb": memory_mb}
        good, todo, chunk = True, list(range(len(works))), partial(Chunk, notes=notes, **how)
        while todo:
            dealt = chunked(todo, self.allocation.jobs, self.waiting.chunk)
            chunks = [chunk(tuple((i, works[i]) for i in d)) for d in dealt]
            with _cancelling(partial(self._submit, folder, chunks)) as watch:
                sent = list(watch.jobs)
                for outcome in watch.outcomes():
                    good &= outcome.error is None
                    yield outcome
            todo = watch.orphans
        if good:
            _tidy(folder, sent)

    def _submit(self, folder: Path, chunks: list[Chunk]) -> Watch:
        jobs = _sbatch(folder, self.allocation, chunks)
        pairs = list(zip(jobs, chunks, strict=True))
        return Watch(
            jobs={job.job_id: {index for index, _ in chunk.works} for job, chunk in pairs},
            logs={job.job_id: job.paths.stderr for job in jobs},
            notes=chunks[0].notes,
            queue=queue.ask,
            poll_s=self.waiting.poll_s,
            patience_s=self.waiting.patience_s,
        )


def _tidy(folder: Path, jobs: list[str]) -> None:
    """Remove the logs of `jobs`, which still write to them a moment after their last note."""
    for _ in range(WARNING_S):
        states = queue.ask(jobs) or {}
        if not any(state.is_open for state in states.values()):
            break
        time.sleep(1.0)
    shutil.rmtree(folder, ignore_errors=True)


def _check_time(limit_s: float, minutes: int) -> None:
    """One piece of work must fit into a job, or the job would never come to an end."""
    if math.isfinite(limit_s) and limit_s > minutes * 60 - WARNING_S:
        raise BadParams(
            f"one piece of work may take {limit_s:g} s (time_limit_s of this stage), but a job "
            f"{minutes} min less {WARNING_S} s: raise INDUSTNERF_SLURM_MINUTES"
        )


def _sbatch(folder: Path, allocation: Allocation, chunks: list[Chunk]) -> list[Any]:
    """One array of `chunks`; raises BadParams with what sbatch says if it refuses."""
    from submitit import SlurmExecutor
    from submitit.core.utils import FailedJobError, FailedSubmissionError

    # A job that meets its time limit goes on; if it ended no piece since, it never will.
    executor = SlurmExecutor(folder, max_num_timeout=len(chunks[0].works))
    executor.update_parameters(**allocation.for_sbatch())
    try:
        return executor.submit_array(chunks)
    except (FailedJobError, FailedSubmissionError) as error:
        raise BadParams(f"sbatch refused {allocation}: {error}") from None


@contextmanager
def _cancelling(submit: Callable[[], Watch]) -> Iterator[Watch]:
    """Whatever ends this process before the jobs of `submit`, or gives them up, cancels them.

    SIGTERM is what a stage gets when `dvc` is ended, SIGHUP when its terminal goes.  While sbatch
    takes the jobs they wait: of those that were taken nobody would know.
    """

    def end(signum: int, frame: object) -> None:
        sys.exit(128 + signum)

    main = threading.current_thread() is threading.main_thread()
    ending = signal.SIGTERM, signal.SIGHUP
    # nohup has SIGHUP ignored; a handler that Python does not know could not be put back
    heeded = [n for n in ending if signal.getsignal(n) not in (signal.SIG_IGN, None)]
    before = {number: signal.signal(number, end) for number in heeded} if main else {}
    watch = None
    try:
        with put_off():
            watch = submit()
        yield watch
    finally:
        if watch and (left := [*watch.jobs, *watch.hopeless]):
            with put_off():  # whatever else comes, to scancel too
                queue.cancel(left)
        for number, handler in before.items():
            signal.signal(number, handler)
