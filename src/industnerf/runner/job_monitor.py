"""Wait for jobs without trusting them to come back.

A job has done its part where the store and its notes say so, whatever SLURM thinks of it.  SLURM
is asked only whether it is worth waiting any longer.
"""

import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from industnerf.runner.base import WorkResult
from industnerf.runner.job_status import JobStatus
from industnerf.runner.queue import CANCELLED, JobState

QueryStates = Callable[[Iterable[str]], Mapping[str, JobState] | None]


@dataclass
class JobMonitor:
    """Jobs and the numbers of the pieces of work that each of them is yet to do.

    `unstarted` are pieces that may be given to other jobs: theirs died at another piece, before it
    came to them.  `abandoned` are jobs that were given up, though they did not end.
    """

    jobs: dict[str, set[int]]
    status: JobStatus
    logs: Mapping[str, Path]
    query_states: QueryStates
    poll_s: float
    patience_s: float
    sleep: Callable[[float], None] = time.sleep
    clock: Callable[[], float] = time.monotonic
    unstarted: list[int] = field(default_factory=list)
    abandoned: list[str] = field(default_factory=list)

    def results(self) -> Iterator[WorkResult]:
        """The outcome of every piece but the unstarted ones, as soon as it is known.

        Ends by itself: a job that works is ended by SLURM's time limit, and if none works and
        nothing is heard for `patience_s` the rest are given up.
        """
        last_news, closed_before = self.clock(), set[str]()
        while self.jobs:
            # The queue before the notes: what a job noted that has ended is then seen.
            states = self.query_states(self.jobs)
            new_results = self._new_results()
            yield from new_results
            is_working = any(state.is_working for state in (states or {}).values())
            if new_results or is_working:
                last_news = self.clock()
            # Twice, because on network file systems the last notes may take a moment.
            closed = {job for job, state in (states or {}).items() if not state.is_open}
            for job in closed & closed_before & set(self.jobs):
                yield from self._fail_job(job, states[job])
            closed_before = closed
            if self.clock() - last_news >= self.patience_s:
                yield from self._give_up(states)
            if self.jobs:
                self.sleep(self.poll_s)

    def _new_results(self) -> list[WorkResult]:
        finished = self.status.finished()
        new_results = [
            self.status.result(i) for remaining in self.jobs.values() for i in remaining & finished
        ]
        self.jobs = {
            job: remaining - finished
            for job, remaining in self.jobs.items()
            if remaining - finished
        }
        return new_results

    def _fail_job(self, job: str, state: JobState) -> Iterator[WorkResult]:
        """A job that ended at some of its pieces: they fail, and those after them are unstarted."""
        remaining = self.jobs.pop(job)
        started = remaining & self.status.started()
        failed = started if started and state.name != CANCELLED else remaining
        self.unstarted += sorted(remaining - failed)
        for index in sorted(failed):
            message = f"SLURM job {job} ended without a result: {state}; {self._log(job)}"
            yield WorkResult(index, message, lost=True)

    def _give_up(self, states: Mapping[str, JobState] | None) -> Iterator[WorkResult]:
        """All pieces that are left fail."""
        minutes = f"{self.patience_s / 60:g} min (INDUSTNERF_SLURM_PATIENCE_MIN)"
        for job, remaining in self.jobs.items():
            state = "squeue does not answer" if states is None else str(states[job])
            message = f"SLURM job {job}: nothing heard for {minutes}: {state}; {self._log(job)}"
            for index in sorted(remaining):
                yield WorkResult(index, message, lost=True)
        self.abandoned, self.jobs = list(self.jobs), {}

    def _log(self, job: str) -> str:
        path = self.logs[job]
        return f"its log: {path}" if path.exists() else "it wrote no log"
