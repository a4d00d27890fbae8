"""Wait for jobs without trusting them to come back.

A job has done its part where the store and its notes say so, whatever SLURM thinks of it.  SLURM
is asked only whether it is worth waiting any longer.
"""

import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from industnerf.runner.base import Outcome
from industnerf.runner.notes import Notes
from industnerf.runner.queue import CANCELLED, State

Queue = Callable[[Iterable[str]], Mapping[str, State] | None]


@dataclass
class Watch:
    """Jobs and the numbers of the pieces of work that each of them is yet to do.

    `orphans` are pieces that may be given to other jobs: theirs died at another piece, before it
    came to them.  `hopeless` are jobs that were given up, though they did not end.
    """

    jobs: dict[str, set[int]]
    notes: Notes
    logs: Mapping[str, Path]
    queue: Queue
    poll_s: float
    patience_s: float
    sleep: Callable[[float], None] = time.sleep
    clock: Callable[[], float] = time.monotonic
    orphans: list[int] = field(default_factory=list)
    hopeless: list[str] = field(default_factory=list)

    def outcomes(self) -> Iterator[Outcome]:
        """The outcome of every piece but the orphans, as soon as it is known.

        Ends by itself: a job that works is ended by SLURM's time limit, and if none works and
        nothing is heard for `patience_s` the rest are given up.
        """
        heard, closed_before = self.clock(), set[str]()
        while self.jobs:
            # The queue before the notes: what a job noted that has ended is then seen.
            states = self.queue(self.jobs)
            news = self._news()
            yield from news
            working = any(state.is_working for state in (states or {}).values())
            if news or working:
                heard = self.clock()
            # Twice, because on network file systems the last notes may take a moment.
            closed = {job for job, state in (states or {}).items() if not state.is_open}
            for job in closed & closed_before & set(self.jobs):
                yield from self._bury(job, states[job])
            closed_before = closed
            if self.clock() - heard >= self.patience_s:
                yield from self._give_up(states)
            if self.jobs:
                self.sleep(self.poll_s)

    def _news(self) -> list[Outcome]:
        ended = self.notes.ended()
        news = [self.notes.outcome(i) for left in self.jobs.values() for i in left & ended]
        self.jobs = {job: left - ended for job, left in self.jobs.items() if left - ended}
        return news

    def _bury(self, job: str, state: State) -> Iterator[Outcome]:
        """A job that ended at some of its pieces: they fail, and those after them are orphans."""
        left = self.jobs.pop(job)
        begun = left & self.notes.begun()
        failed = begun if begun and state.name != CANCELLED else left
        self.orphans += sorted(left - failed)
        for index in sorted(failed):
            why = f"SLURM job {job} ended without a result: {state}; {self._log(job)}"
            yield Outcome(index, why, lost=True)

    def _give_up(self, states: Mapping[str, State] | None) -> Iterator[Outcome]:
        """All pieces that are left fail."""
        minutes = f"{self.patience_s / 60:g} min (INDUSTNERF_SLURM_PATIENCE_MIN)"
        for job, left in self.jobs.items():
            state = "squeue does not answer" if states is None else str(states[job])
            why = f"SLURM job {job}: nothing heard for {minutes}: {state}; {self._log(job)}"
            for index in sorted(left):
                yield Outcome(index, why, lost=True)
        self.hopeless, self.jobs = list(self.jobs), {}

    def _log(self, job: str) -> str:
        path = self.logs[job]
        return f"its log: {path}" if path.exists() else "it wrote no log"
