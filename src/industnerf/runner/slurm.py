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
    WaitSettings,
    allocation_from_environment,
    wait_settings_from_environment,
)
from industnerf.runner.base import WorkItem, WorkResult
from industnerf.runner.chunk import Chunk, split_into_chunks
from industnerf.runner.job_monitor import JobMonitor
from industnerf.runner.job_status import JobStatus
from industnerf.runner.signals import defer_signals

PROGRAMS = ("sbatch", "squeue", "scancel", "srun")


def slurm_from_environment() -> "SlurmRunner":
    """The runner that INDUSTNERF_SLURM_* describe; raises BadParams where it cannot work."""
    if find_spec("submitit") is None:
        raise BadParams(
            "INDUSTNERF_RUNNER=submitit needs the package submitit: pip install -e '.[slurm]'"
        )
    if missing := [name for name in PROGRAMS if not shutil.which(name)]:
        raise BadParams(
            f"INDUSTNERF_RUNNER=submitit needs {', '.join(missing)} of SLURM, not found here"
        )
    return SlurmRunner(allocation_from_environment(), wait_settings_from_environment())


@dataclass(frozen=True)
class SlurmRunner:
    """Job arrays; in a job every piece of work has a process of its own."""

    allocation: Allocation
    wait_settings: WaitSettings

    def map(
        self, work_items: Sequence[WorkItem], limit_s: float, memory_mb: int | None = None
    ) -> Iterator[WorkResult]:
        _require_fits_job(limit_s, self.allocation.minutes)
        if not work_items:
            return
        self.wait_settings.folder.mkdir(parents=True, exist_ok=True)
        folder = Path(tempfile.mkdtemp(prefix="run-", dir=self.wait_settings.folder))
        status = JobStatus(folder / "status")
        status.folder.mkdir()
        limits = {"workers": self.allocation.cpus, "limit_s": limit_s, "memory_mb": memory_mb}
        all_succeeded = True
        pending = list(range(len(work_items)))
        make_chunk = partial(Chunk, status=status, **limits)
        while pending:
            index_chunks = split_into_chunks(
                pending, self.allocation.jobs, self.wait_settings.chunk
            )
            chunks = [
                make_chunk(tuple((i, work_items[i]) for i in indices)) for indices in index_chunks
            ]
            with _cancel_on_exit(partial(self._submit, folder, chunks)) as monitor:
                job_ids = list(monitor.jobs)
                for result in monitor.results():
                    all_succeeded &= result.error is None
                    yield result
            pending = monitor.unstarted
        if all_succeeded:
            _remove_logs(folder, job_ids)

    def _submit(self, folder: Path, chunks: list[Chunk]) -> JobMonitor:
        jobs = _sbatch(folder, self.allocation, chunks)
        pairs = list(zip(jobs, chunks, strict=True))
        return JobMonitor(
            jobs={job.job_id: {index for index, _ in chunk.work_items} for job, chunk in pairs},
            logs={job.job_id: job.paths.stderr for job in jobs},
            status=chunks[0].status,
            query_states=queue.query_states,
            poll_s=self.wait_settings.poll_s,
            patience_s=self.wait_settings.patience_s,
        )


def _remove_logs(folder: Path, jobs: list[str]) -> None:
    """Remove the logs of `jobs`, which still write to them a moment after their last note."""
    for _ in range(WARNING_S):
        states = queue.query_states(jobs) or {}
        if not any(state.is_open for state in states.values()):
            break
        time.sleep(1.0)
    shutil.rmtree(folder, ignore_errors=True)


def _require_fits_job(limit_s: float, minutes: int) -> None:
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
    executor = SlurmExecutor(folder, max_num_timeout=len(chunks[0].work_items))
    executor.update_parameters(**allocation.sbatch_options())
    try:
        return executor.submit_array(chunks)
    except (FailedJobError, FailedSubmissionError) as error:
        raise BadParams(f"sbatch refused {allocation}: {error}") from None


@contextmanager
def _cancel_on_exit(submit: Callable[[], JobMonitor]) -> Iterator[JobMonitor]:
    """Whatever ends this process before the jobs of `submit`, or gives them up, cancels them.

    SIGTERM is what a stage gets when `dvc` is ended, SIGHUP when its terminal goes.  While sbatch
    takes the jobs they wait: of those that were taken nobody would know.
    """

    def exit_on_signal(signum: int, frame: object) -> None:
        sys.exit(128 + signum)

    main = threading.current_thread() is threading.main_thread()
    signals = signal.SIGTERM, signal.SIGHUP
    # nohup has SIGHUP ignored; a handler that Python does not know could not be put back
    handled = [n for n in signals if signal.getsignal(n) not in (signal.SIG_IGN, None)]
    handlers = {number: signal.signal(number, exit_on_signal) for number in handled} if main else {}
    monitor = None
    try:
        with defer_signals():
            monitor = submit()
        yield monitor
    finally:
        if monitor and (unfinished := [*monitor.jobs, *monitor.abandoned]):
            with defer_signals():  # whatever else comes, to scancel too
                queue.cancel_jobs(unfinished)
        for number, handler in handlers.items():
            signal.signal(number, handler)
