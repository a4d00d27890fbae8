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

from industnerf.runner.base import (
    WorkError,
    WorkItem,
    WorkResult,
    group_of,
    next_piece,
    run_work_item,
)

# POT imports torch where it finds it, which takes a second; it is given NumPy's arrays alone.
NUMPY_ALONE = {"POT_BACKEND_DISABLE_PYTORCH": "1"}
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "RAYON_NUM_THREADS")
POLL_S = 1.0  # look at least so often; if much more time has passed, this process was stopped
KILL_GRACE_S = 1.0  # within it, whoever kills every process of a job has come to this one too


@dataclass(frozen=True)
class SerialRunner:
    """One piece after the other in this process: for debugging.

    It cannot end a piece that hangs, and one that crashes takes everything down.  It sets no limit
    of memory either: what this process holds already would count.
    """

    def map(
        self, work_items: Sequence[WorkItem], limit_s: float, memory_mb: int | None = None
    ) -> Iterator[WorkResult]:
        for index, work_item in enumerate(work_items):
            yield WorkResult.from_error(index, run_work_item(work_item, None))


@dataclass(frozen=True)
class ProcessRunner:
    """Local processes of one thread each; one that dies or hangs is replaced.

    The time in which this process is stopped (Ctrl-Z, SLURM's SUSPEND) counts as nobody's.

    `blocked_signals` do not reach them: SLURM sends to all processes of a job what is meant for
    the first.
    """

    workers: int
    blocked_signals: tuple[signal.Signals, ...] = ()

    def map(
        self, work_items: Sequence[WorkItem], limit_s: float, memory_mb: int | None = None
    ) -> Iterator[WorkResult]:
        # inherited by the workers, before they import numpy
        os.environ.update(dict.fromkeys(THREADS, "1") | NUMPY_ALONE)
        limits = _Limits(limit_s, memory_mb, self.blocked_signals)
        pending, groups = list(range(len(work_items))), [group_of(item) for item in work_items]
        workers: dict[Connection, _Worker] = {}

        def take(own: str | None) -> tuple[int, WorkItem]:
            index = next_piece(pending, groups, own, {worker.group for worker in workers.values()})
            pending.remove(index)
            return index, work_items[index]

        try:
            for _ in range(min(self.workers, len(work_items))):
                worker = _Worker.start(take(None), limits)
                workers[worker.connection] = worker
            while workers:
                next_deadline = min(worker.deadline for worker in workers.values())
                wait_start = time.monotonic()
                ready = wait(
                    list(workers), timeout=min(max(next_deadline - wait_start, 0.0), POLL_S)
                )
                paused = time.monotonic() - wait_start - 2 * POLL_S
                for worker in workers.values():
                    worker.deadline += max(paused, 0.0)
                expired = [c for c, w in workers.items() if w.deadline <= time.monotonic()]
                for connection in {*ready, *expired}:
                    worker = workers.pop(connection)
                    error = worker.collect(limits)
                    if error and error.requires_restart:
                        worker.stop()
                    yield WorkResult.from_error(worker.index, error)
                    if pending:
                        worker = worker.reassign(take(worker.group), limits)
                        workers[worker.connection] = worker
                    else:
                        worker.stop()
        finally:
            for worker in workers.values():
                worker.stop()


@dataclass(frozen=True)
class _Limits:
    """What one piece of work may take, by the section of its stage in params.yaml.

    It also may not be reached by the `blocked_signals`.
    """

    seconds: float
    memory_mb: int | None
    blocked_signals: tuple[signal.Signals, ...]

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
    group: str

    @staticmethod
    def start(item: tuple[int, WorkItem], limits: _Limits) -> "_Worker":
        context = multiprocessing.get_context("spawn")
        own_end, child_end = context.Pipe()
        process = context.Process(target=_worker_loop, args=(child_end,), daemon=True)
        with _block_signals(limits.blocked_signals):
            process.start()
        child_end.close()
        own_end.send((item[1], limits.memory_mb))
        deadline = time.monotonic() + limits.seconds
        return _Worker(process, own_end, item[0], deadline, group_of(item[1]))

    def collect(self, limits: _Limits) -> WorkError | None:
        """What ended the current piece of work, or None."""
        if not self.connection.poll():
            self.stop()
            return WorkError(f"timed out: more than {limits.seconds:g} s (time_limit_s)")
        try:
            return self.connection.recv()
        except (EOFError, OSError):
            self.process.join()
            code = self.process.exitcode
            message = f"crashed: its process ended with exit code {code}"
            if code != -signal.SIGKILL:
                return WorkError(message + limits.hint)
            time.sleep(KILL_GRACE_S)  # if we are next, the piece has not failed: say nothing
            # not `memory_limit_mb`, which ends otherwise: the machine had no memory left
            return WorkError(
                f"{message}; fewer INDUSTNERF_WORKERS leave more memory to each", lost=True
            )

    def reassign(self, item: tuple[int, WorkItem], limits: _Limits) -> "_Worker":
        """This worker at another piece of work, or a fresh one if that is of another group, or if
        it is dead.
        """
        if group_of(item[1]) != self.group:
            self.stop()
            return _Worker.start(item, limits)
        try:
            self.connection.send((item[1], limits.memory_mb))
        except OSError:  # nobody is at the other end
            self.stop()
            return _Worker.start(item, limits)
        self.index, self.deadline = item[0], time.monotonic() + limits.seconds
        return self

    def stop(self) -> None:
        self.process.kill()
        self.process.join()


@contextmanager
def _block_signals(signals: tuple[signal.Signals, ...]) -> Iterator[None]:
    """What is started meanwhile inherits that these signals wait, and so they never arrive."""
    resource_tracker.ensure_running()  # multiprocessing starts it else, and then unblocks SIGTERM
    old_mask = signal.pthread_sigmask(signal.SIG_BLOCK, signals)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, old_mask)


def _worker_loop(connection: Connection) -> None:
    die_with_parent(signal.SIGKILL)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches the parent, which ends us
    while True:
        try:
            work_item, memory_mb = connection.recv()
        except EOFError:
            return
        connection.send(run_work_item(work_item, memory_mb))


def die_with_parent(signum: signal.Signals = signal.SIGTERM) -> None:
    """Ask Linux to send this process `signum` when its parent dies; elsewhere do nothing.

    `dvc` that is killed leaves its stage running, and the next `dvc repro` would start a second.
    """
    import ctypes

    try:
        ctypes.CDLL(None).prctl(1, int(signum))  # PR_SET_PDEATHSIG
    except (AttributeError, OSError):
        return
