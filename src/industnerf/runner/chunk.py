"""What one SLURM job does: some pieces of work, and notes on how each of them ended."""

import signal
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from industnerf.runner.base import GroupedWork, WorkItem, group_of
from industnerf.runner.device import check_device
from industnerf.runner.job_status import JobStatus
from industnerf.runner.processes import ProcessRunner

MAX_ARRAY_JOBS = 1000  # jobs in an array; SLURM's own default limit (MaxArraySize) is 1001
JOBS_PER_SLOT = (
    4  # jobs for each one that may run at a time: the slowest then ends little after the rest
)
# Before it ends or requeues a job, SLURM sends these to every process of it.
JOB_SIGNALS = (signal.SIGTERM, signal.SIGUSR2)


def split_into_chunks(
    indices: Sequence[int], parallel_jobs: int, min_size: int | None = None
) -> list[list[int]]:
    """`indices` dealt out to jobs of which `parallel_jobs` run together, as evenly as possible.

    Each has at least `min_size` pieces if that is given, as long as there are so many; there are
    never more than MAX_ARRAY_JOBS jobs.
    """
    max_jobs = min(
        MAX_ARRAY_JOBS,
        JOBS_PER_SLOT * parallel_jobs if min_size is None else len(indices) // min_size,
    )
    count = min(max(1, max_jobs), len(indices))
    return [list(indices[first::count]) for first in range(count)]


@dataclass(frozen=True)
class Chunk:
    """Pieces of work with their numbers; each in a process of its own, as on one machine.

    A job that starts again, requeued by SLURM or by the signal, goes on after what is noted.
    """

    work_items: tuple[tuple[int, WorkItem], ...]
    status: JobStatus
    workers: int
    limit_s: float
    memory_mb: int | None

    def __call__(self) -> None:
        check_device(here=True)  # the job ends, and its pieces are lost; they have not failed
        finished = self.status.finished()
        remaining = [
            (index, work_item) for index, work_item in self.work_items if index not in finished
        ]
        work_items = [
            GroupedWork(partial(self.status.run, index, work_item), group_of(work_item))
            for index, work_item in remaining
        ]
        runner = ProcessRunner(self.workers, JOB_SIGNALS)
        for result in runner.map(work_items, self.limit_s, self.memory_mb):
            self.status.write(replace(result, index=remaining[result.index][0]))

    def checkpoint(self) -> Any:
        """What submitit asks for after SIGUSR2, before it requeues the job: the same again."""
        from submitit.helpers import DelayedSubmission

        return DelayedSubmission(self)
