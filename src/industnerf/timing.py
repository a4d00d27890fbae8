"""Seconds by the clock, and of the processor: a busy machine lengthens the first alone."""

import resource
import time
from dataclasses import dataclass


@dataclass(frozen=True)
class Timing:
    """A moment, or the time between two."""

    wall: float  # s, by the clock
    cpu: float  # s of user and system, of all threads and of child processes that have ended

    @staticmethod
    def now() -> "Timing":
        """This moment; only differences mean anything."""
        children = resource.getrusage(resource.RUSAGE_CHILDREN)
        cpu = time.process_time() + children.ru_utime + children.ru_stime
        return Timing(time.perf_counter(), cpu)

    def __sub__(self, other: "Timing") -> "Timing":
        return Timing(self.wall - other.wall, self.cpu - other.cpu)


NO_TIME = Timing(0.0, 0.0)
