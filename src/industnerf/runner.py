"""Where work on parts is executed.  The result of a piece of work is what it put in the store.

`Runner.map` is the whole interface, so a cluster joins as one more class.  How to execute comes
from the environment, never from params.yaml, and never changes a result:

    INDUSTNERF_RUNNER    process (default) or serial
    INDUSTNERF_WORKERS   number of processes; default: the cores this process may use
"""

import math
import multiprocessing
import os
import signal
import time
import traceback
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from typing import Any, Protocol, runtime_checkable

from industnerf.errors import BadParams, SuiteError

Work = Callable[[], None]
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "RAYON_NUM_THREADS")


@dataclass(frozen=True)
class Outcome:
    """How the piece of work number `index` ended; `error` is None where it succeeded."""

    index: int
    error: str | None


@runtime_checkable
class Runner(Protocol):
    def map(
        self, works: Sequence[Work], limit_s: float, memory_mb: int | None = None
    ) -> Iterator[Outcome]:
        """Do every piece of work, and yield each outcome as soon as it is known.

        Failure, a crash, more than `limit_s` seconds or an address space of more than `memory_mb`
        end one piece of work, not the others.
        """


def runner_from_environment() -> Runner:
    """The runner that INDUSTNERF_RUNNER names; raises BadParams for an unknown one."""
    name = os.environ.get("INDUSTNERF_RUNNER", "process")
    if name == "serial":
        return SerialRunner()
    if name == "process":
        workers = os.environ.get("INDUSTNERF_WORKERS", str(len(os.sched_getaffinity(0))))
        if not workers.isdigit() or int(workers) < 1:
            raise BadParams(f"INDUSTNERF_WORKERS is {workers!r}, must be a number of processes")
        return ProcessRunner(int(workers))
    raise BadParams(f"INDUSTNERF_RUNNER is {name!r}, must be process or serial")


@dataclass(frozen=True)
class SerialRunner:
    """One piece after the other in this process: for debugging.

    It cannot end a piece that hangs, and one that crashes takes everything down.  It sets no limit
    of memory either: what this process holds already would count.
    """

    def map(
        self, works: Sequence[Work], limit_s: float, memory_mb: int | None = None
    ) -> Iterator[Outcome]:
        for index, work in enumerate(works):
            yield Outcome(index, _attempt(work, None))


@dataclass(frozen=True)
class ProcessRunner:
    """Local processes of one thread each; one that dies or hangs is replaced."""

    workers: int

    def map(
        self, works: Sequence[Work], limit_s: float, memory_mb: int | None = None
    ) -> Iterator[Outcome]:
        os.environ.update(
            dict.fromkeys(THREADS, "1")
        )  # inherited by the workers, before they import numpy
        limits = _Limits(limit_s, memory_mb)
        todo = list(enumerate(works))[::-1]
        busy: dict[Connection, _Worker] = {}
        try:
            for _ in range(min(self.workers, len(works))):
                worker = _Worker.start(todo.pop(), limits)
                busy[worker.connection] = worker
            while busy:
                soonest = min(worker.deadline for worker in busy.values())
                patience = max(soonest - time.monotonic(), 0.0)
                ready = wait(list(busy), timeout=None if math.isinf(patience) else patience)
                late = [c for c, w in busy.items() if w.deadline <= time.monotonic()]
                for connection in {*ready, *late}:
                    worker = busy.pop(connection)
                    yield Outcome(worker.index, worker.collect(limits))
                    if todo:
                        worker = worker.next(todo.pop(), limits)
                        busy[worker.connection] = worker
                    else:
                        worker.stop()
        finally:
            for worker in busy.values():
                worker.stop()


@dataclass(frozen=True)
class _Limits:
    """What one piece of work may take; params.yaml has both under the section of its stage."""

    seconds: float
    memory_mb: int | None

    @property
    def hint(self) -> str:
        """What a process that died may have died of."""
        if self.memory_mb is None:
            return ""
        return f"; it may have needed more than {self.memory_mb} MB (memory_limit_mb)"


@dataclass
class _Worker:
    """A child process and the piece of work it is at."""

    process: Any
    connection: Connection
    index: int
    deadline: float

    @staticmethod
    def start(task: tuple[int, Work], limits: _Limits) -> "_Worker":
        context = multiprocessing.get_context("spawn")
        ours, theirs = context.Pipe()
        process = context.Process(target=_serve, args=(theirs,), daemon=True)
        process.start()
        theirs.close()
        ours.send((task[1], limits.memory_mb))
        return _Worker(process, ours, task[0], time.monotonic() + limits.seconds)

    def collect(self, limits: _Limits) -> str | None:
        """The error of the current piece of work, or None."""
        if not self.connection.poll():
            self.stop()
            return f"timed out: more than {limits.seconds:g} s (time_limit_s)"
        try:
            return self.connection.recv()
        except (EOFError, OSError):
            self.process.join()
            code = self.process.exitcode
            return f"crashed: its process ended with exit code {code}{limits.hint}"

    def next(self, task: tuple[int, Work], limits: _Limits) -> "_Worker":
        """This worker at another piece of work, or a fresh one if it is dead."""
        if not self.process.is_alive():
            return _Worker.start(task, limits)
        self.connection.send((task[1], limits.memory_mb))
        self.index, self.deadline = task[0], time.monotonic() + limits.seconds
        return self

    def stop(self) -> None:
        self.process.kill()
        self.process.join()


def _serve(connection: Connection) -> None:
    die_with_parent()
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches the parent, which ends us
    while True:
        try:
            work, memory_mb = connection.recv()
        except EOFError:
            return
        connection.send(_attempt(work, memory_mb))


def _attempt(work: Work, memory_mb: int | None) -> str | None:
    try:
        with _address_space(memory_mb):
            work()
    except SuiteError as error:
        return str(error)
    except MemoryError:
        most = "there is" if memory_mb is None else f"{memory_mb} MB (memory_limit_mb)"
        return f"out of memory: needs more than {most}"
    except Exception as error:
        if os.environ.get("INDUSTNERF_DEBUG"):
            traceback.print_exc()
        return f"{type(error).__name__}: {error} (INDUSTNERF_DEBUG=1 prints the traceback)"
    return None


@contextmanager
def _address_space(memory_mb: int | None) -> Iterator[None]:
    """Let this process have at most `memory_mb`, counted as Linux counts addresses; then no more.

    A system that does not know the limit goes without.
    """
    import resource

    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    if memory_mb is not None:
        wanted = memory_mb * 2**20
        _limit(wanted if hard == resource.RLIM_INFINITY else min(wanted, hard), hard)
    try:
        yield
    finally:
        _limit(soft, hard)


def _limit(soft: int, hard: int) -> None:
    import resource

    try:
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))
    except (ValueError, OSError):
        return


def die_with_parent() -> None:
    """Ask Linux to end this process when its parent dies; elsewhere do nothing.

    `dvc` that is killed leaves its stage running, and the next `dvc repro` would start a second.
    """
    import ctypes

    try:
        ctypes.CDLL(None).prctl(1, signal.SIGTERM)  # PR_SET_PDEATHSIG
    except (AttributeError, OSError):
        return
