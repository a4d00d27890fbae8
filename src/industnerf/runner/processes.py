"""Pieces of work in this process, or in local ones of one thread each."""

import multiprocessing
import os
import signal
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import resource_tracker
from multiprocessing.connection import Connection, wait
from typing import Any

from industnerf.runner.base import Fault, Outcome, Work, attempt

THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "RAYON_NUM_THREADS")
LOOK_S = 1.0  # look at least so often; if much more time has passed, this process was stopped
KILL_S = 1.0  # within it, whoever kills every process of a job has come to this one too


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
            yield Outcome.of(index, attempt(work, None))


@dataclass(frozen=True)
class ProcessRunner:
    """Local processes of one thread each; one that dies or hangs is replaced.

    The time in which this process is stopped (Ctrl-Z, SLURM's SUSPEND) counts as nobody's.

    `shielded` signals do not reach them: SLURM sends to all processes of a job what is meant for
    the first.
    """

    workers: int
    shielded: tuple[signal.Signals, ...] = ()

    def map(
        self, works: Sequence[Work], limit_s: float, memory_mb: int | None = None
    ) -> Iterator[Outcome]:
        # inherited by the workers, before they import numpy
        os.environ.update(dict.fromkeys(THREADS, "1"))
        limits = _Limits(limit_s, memory_mb, self.shielded)
        todo = list(enumerate(works))[::-1]
        busy: dict[Connection, _Worker] = {}
        try:
            for _ in range(min(self.workers, len(works))):
                worker = _Worker.start(todo.pop(), limits)
                busy[worker.connection] = worker
            while busy:
                soonest = min(worker.deadline for worker in busy.values())
                begun = time.monotonic()
                ready = wait(list(busy), timeout=min(max(soonest - begun, 0.0), LOOK_S))
                paused = time.monotonic() - begun - 2 * LOOK_S
                for worker in busy.values():
                    worker.deadline += max(paused, 0.0)
                late = [c for c, w in busy.items() if w.deadline <= time.monotonic()]
                for connection in {*ready, *late}:
                    worker = busy.pop(connection)
                    fault = worker.collect(limits)
                    if fault and fault.spoils_process:
                        worker.stop()
                    yield Outcome.of(worker.index, fault)
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
    """What one piece of work may take, by the section of its stage in params.yaml.

    It also may not be reached by the signals `shielded`.
    """

    seconds: float
    memory_mb: int | None
    shielded: tuple[signal.Signals, ...]

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
        with _blocked(limits.shielded):
            process.start()
        theirs.close()
        ours.send((task[1], limits.memory_mb))
        return _Worker(process, ours, task[0], time.monotonic() + limits.seconds)

    def collect(self, limits: _Limits) -> Fault | None:
        """What ended the current piece of work, or None."""
        if not self.connection.poll():
            self.stop()
            return Fault(f"timed out: more than {limits.seconds:g} s (time_limit_s)")
        try:
            return self.connection.recv()
        except (EOFError, OSError):
            self.process.join()
            code = self.process.exitcode
            said = f"crashed: its process ended with exit code {code}"
            if code != -signal.SIGKILL:
                return Fault(said + limits.hint)
            time.sleep(KILL_S)  # if we are next, the piece has not failed: say nothing
            # not `memory_limit_mb`, which ends otherwise: the machine had no memory left
            return Fault(f"{said}; fewer INDUSTNERF_WORKERS leave more memory to each", lost=True)

    def next(self, task: tuple[int, Work], limits: _Limits) -> "_Worker":
        """This worker at another piece of work, or a fresh one if it is dead."""
        try:
            self.connection.send((task[1], limits.memory_mb))
        except OSError:  # nobody is at the other end
            self.stop()
            return _Worker.start(task, limits)
        self.index, self.deadline = task[0], time.monotonic() + limits.seconds
        return self

    def stop(self) -> None:
        self.process.kill()
        self.process.join()


@contextmanager
def _blocked(signals: tuple[signal.Signals, ...]) -> Iterator[None]:
    """What is started meanwhile inherits that these signals wait, and so they never arrive."""
    resource_tracker.ensure_running()  # multiprocessing starts it else, and then unblocks SIGTERM
    before = signal.pthread_sigmask(signal.SIG_BLOCK, signals)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _serve(connection: Connection) -> None:
    die_with_parent(signal.SIGKILL)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches the parent, which ends us
    while True:
        try:
            work, memory_mb = connection.recv()
        except EOFError:
            return
        connection.send(attempt(work, memory_mb))


def die_with_parent(how: signal.Signals = signal.SIGTERM) -> None:
    """Ask Linux to send this process the signal `how` when its parent dies; elsewhere do nothing.

    `dvc` that is killed leaves its stage running, and the next `dvc repro` would start a second.
    """
    import ctypes

    try:
        ctypes.CDLL(None).prctl(1, int(how))  # PR_SET_PDEATHSIG
    except (AttributeError, OSError):
        return
