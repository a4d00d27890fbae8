"""What one SLURM job does: some pieces of work, and notes on how each of them ended."""

import signal
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from industnerf.runner.base import Work
from industnerf.runner.device import check_device
from industnerf.runner.notes import Notes
from industnerf.runner.processes import ProcessRunner

ARRAY_MOST = 1000  # jobs in an array; SLURM's own default limit (MaxArraySize) is 1001
ROUNDS = 4  # jobs for each one that may run at a time: the slowest then ends little after the rest
# Before it ends or requeues a job, SLURM sends these to every process of it.
FOR_THE_JOB = (signal.SIGTERM, signal.SIGUSR2)


def chunked(pieces: Sequence[int], at_a_time: int, least: int | None = None) -> list[list[int]]:
    """`pieces` dealt out to jobs of which `at_a_time` run together, as evenly as possible.

    Each has at least `least` pieces if that is given, as long as there are so many; more than
    ARRAY_MOST jobs there are never.
    """
    most = min(ARRAY_MOST, ROUNDS * at_a_time if least is None else len(pieces) // least)
    count = min(max(1, most), len(pieces))
    return [list(pieces[first::count]) for first in range(count)]


@dataclass(frozen=True)
class Chunk:
    """Pieces of work with their numbers; each in a process of its own, as on one machine.

    A job that starts again, requeued by SLURM or by the signal, goes on after what is noted.
    """

    works: tuple[tuple[int, Work], ...]
    notes: Notes
    workers: int
    limit_s: float
    memory_mb: int | None

    def __call__(self) -> None:
        check_device(here=True)  # the job ends, and its pieces are lost; they have not failed
        ended = self.notes.ended()
        left = [(index, work) for index, work in self.works if index not in ended]
        works = [partial(self.notes.begin, index, work) for index, work in left]
        runner = ProcessRunner(self.workers, FOR_THE_JOB)
        for outcome in runner.map(works, self.limit_s, self.memory_mb):
            self.notes.write(replace(outcome, index=left[outcome.index][0]))

    def checkpoint(self) -> Any:
        """What submitit asks for after SIGUSR2, before it requeues the job: the same again."""
        from submitit.helpers import DelayedSubmission

        return DelayedSubmission(self)
