"""What a runner is, and how a piece of work ends."""

import errno
import os
import re
import traceback
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from industnerf.errors import SuiteError

WorkItem = Callable[[], None]

# What is wrong with the machine, whatever the piece: a disk is full, read-only or does not answer,
# or no more files can be open.
MACHINE_ERRNOS = {errno.ENOSPC, errno.EDQUOT, errno.EROFS, errno.EIO, errno.ESTALE, errno.ENFILE}

# What torch and Warp say of a GPU whose memory, which all processes on it share, is used up.
GPU_OUT_OF_MEMORY = re.compile(
    r"CUDA (error: )?out of memory|CUBLAS_STATUS_ALLOC_FAILED"
    r"|Failed to allocate \d+ bytes on device 'cuda"
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
    except SuiteError as error:
        return WorkError(str(error), lost=is_machine_error(error))
    except MemoryError:
        available = "there is" if memory_mb is None else f"{memory_mb} MB (memory_limit_mb)"
        return WorkError(f"out of memory: needs more than {available}")
    except Exception as error:
        if os.environ.get("INDUSTNERF_DEBUG"):
            traceback.print_exc()
        text = f"{type(error).__name__}: {error} (INDUSTNERF_DEBUG=1 prints the traceback)"
        if GPU_OUT_OF_MEMORY.search(text):
            text += "; fewer INDUSTNERF_WORKERS leave more of the GPU to each"
        return WorkError(text, lost=is_machine_error(error))
    return None


def is_machine_error(error: BaseException | None) -> bool:
    """Whether another machine, or this one with more room, might have done the piece.

    What was raised first counts, whatever was said of it on the way.
    """
    while error is not None:
        if isinstance(error, OSError) and error.errno in MACHINE_ERRNOS:
            return True
        if isinstance(error, RuntimeError) and GPU_OUT_OF_MEMORY.search(str(error)):
            return True
        error = error.__context__
    return False


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
