"""What a runner is, and how a piece of work ends."""

import errno
import os
import re
import traceback
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from industnerf.errors import SuiteError

WorkItem = Callable[[], None]


@dataclass(frozen=True)
class GroupedWork:
    """A piece of work whose process does no piece of another group, nor did.

    What one method leaves in memory must not count for another.
    """

    run: WorkItem
    group: str

    def __call__(self) -> None:
        self.run()


def group_of(work_item: WorkItem) -> str:
    """The group of `work_item`; pieces without one are of one group."""
    return work_item.group if isinstance(work_item, GroupedWork) else ""


def next_piece(
    pending: Sequence[int], groups: Sequence[str], own: str | None, busy: Collection[str]
) -> int:
    """Which of the `pending` pieces a process begins that has done pieces of the group `own`.

    One of its own group, else one of a group that none of the `busy` processes is at, else the
    first: so few processes begin each group, and load what its method needs.
    """
    return next(
        (i for i in pending if groups[i] == own),
        next((i for i in pending if groups[i] not in busy), pending[0]),
    )


# What is wrong with the machine, whatever the piece: a disk is full, read-only or does not answer,
# or no more files can be open.
MACHINE_ERRNOS = {errno.ENOSPC, errno.EDQUOT, errno.EROFS, errno.EIO, errno.ESTALE, errno.ENFILE}

# What torch and Warp say of a GPU whose memory, which all processes on it share, is used up.
GPU_OUT_OF_MEMORY = re.compile(
    r"CUDA (error: )?out of memory|CUBLAS_STATUS_ALLOC_FAILED"
    r"|Failed to allocate \d+ bytes on device 'cuda"
)

# The words of torch, of Warp, of C++ libraries for a CPU, and of Python for one thread too many.
OUT_OF_MEMORY = re.compile(
    r"allocate memory|not enough memory|bad_?alloc|Failed to allocate \d+ bytes on device 'cpu"
    r"|can't start new thread",
    re.IGNORECASE,
)

# After any error of the device but that, every call of the same process to it fails.
GPU_FAILURE = re.compile(r"CUDA error|CUDA_ERROR|CUBLAS_STATUS|CUDNN_STATUS")


@dataclass(frozen=True)
class WorkError:
    """What ended a piece of work before it was done; `lost` as in `WorkResult`."""

    text: str
    lost: bool = False

    @property
    def requires_restart(self) -> bool:
        """Whether the process that met it may fail at other pieces too."""
        return bool(GPU_FAILURE.search(self.text))


@dataclass(frozen=True)
class WorkResult:
    """How the piece of work number `index` ended; `error` is None where it succeeded.

    If it is `lost`, what failed is the machinery round the piece, and says nothing of the piece.
    """

    index: int
    error: str | None
    lost: bool = False

    @staticmethod
    def from_error(index: int, error: WorkError | None) -> "WorkResult":
        """How a piece of work ended that ended by itself, and by `error` if there is one."""
        return (
            WorkResult(index, None) if error is None else WorkResult(index, error.text, error.lost)
        )


@runtime_checkable
class Runner(Protocol):
    def map(
        self, work_items: Sequence[WorkItem], limit_s: float, memory_mb: int | None = None
    ) -> Iterator[WorkResult]:
        """Do every piece of work, and yield each outcome as soon as it is known.

        Failure, a crash, more than `limit_s` seconds or an address space of more than `memory_mb`
        end one piece of work, not the others.
        """


def run_work_item(work_item: WorkItem, memory_mb: int | None) -> WorkError | None:
    """Do `work_item` with at most `memory_mb` of addresses; what ended it, or None."""
    try:
        with _limit_memory(memory_mb):
            work_item()
    except Exception as error:
        if os.environ.get("INDUSTNERF_DEBUG") and not isinstance(error, SuiteError):
            traceback.print_exc()
        if memory_mb is not None and _any_cause(error, is_out_of_memory):
            return WorkError(f"out of memory: needs more than {memory_mb} MB (memory_limit_mb)")
        return WorkError(_describe(error), lost=_any_cause(error, is_machine_error))
    return None


def _describe(error: Exception) -> str:
    if isinstance(error, SuiteError):
        return str(error)
    if is_out_of_memory(error):
        text = f"out of memory: {' '.join(str(error).split()) or 'needs more than there is'}"
        return f"{text}; fewer INDUSTNERF_WORKERS leave more memory to each"
    text = f"{type(error).__name__}: {error} (INDUSTNERF_DEBUG=1 prints the traceback)"
    if GPU_OUT_OF_MEMORY.search(text):
        text += "; fewer INDUSTNERF_WORKERS leave more of the GPU to each"
    return text


def _any_cause(error: BaseException | None, holds: Callable[[BaseException], bool]) -> bool:
    """Whether `holds` is true of `error` or of what was raised before it, whatever was said of it
    on the way.
    """
    while error is not None:
        if holds(error):
            return True
        error = error.__context__
    return False


def is_out_of_memory(error: BaseException) -> bool:
    """Whether the memory of the machine, or of its limit, was used up."""
    if isinstance(error, OSError):
        return error.errno == errno.ENOMEM
    return isinstance(error, MemoryError) or (
        isinstance(error, RuntimeError) and bool(OUT_OF_MEMORY.search(str(error)))
    )


def is_machine_error(error: BaseException) -> bool:
    """Whether another machine, or this one with more room, might have done the piece."""
    if isinstance(error, OSError) and error.errno in MACHINE_ERRNOS:
        return True
    if isinstance(error, RuntimeError) and GPU_OUT_OF_MEMORY.search(str(error)):
        return True
    return is_out_of_memory(error)


@contextmanager
def _limit_memory(memory_mb: int | None) -> Iterator[None]:
    """Let this process have at most `memory_mb`, counted as Linux counts addresses; then no more.

    A system that does not know the limit goes without.
    """
    import resource

    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    if memory_mb is not None:
        requested = memory_mb * 2**20
        _set_limit(requested if hard == resource.RLIM_INFINITY else min(requested, hard), hard)
    try:
        yield
    finally:
        _set_limit(soft, hard)


def _set_limit(soft: int, hard: int) -> None:
    import resource

    try:
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))
    except (ValueError, OSError):
        return
