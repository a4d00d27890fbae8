"""Ctrl-C that leaves time for a checkpoint."""

import os
import signal
import sys
from types import FrameType, TracebackType

NOTICE = b"\ninterrupted: ends at the next checkpoint or when done; Ctrl-C again ends at once\n"


class GracefulInterrupt:
    """While entered, the first Ctrl-C is only noted in `asked`; the second raises."""

    def __init__(self) -> None:
        self.requested = False

    def __enter__(self) -> "GracefulInterrupt":
        self._previous_handler = signal.signal(signal.SIGINT, self._handle)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        signal.signal(signal.SIGINT, self._previous_handler)

    def _handle(self, number: int, frame: FrameType | None) -> None:
        if self.requested:
            raise KeyboardInterrupt
        self.requested = True
        # not print: the signal may come in the middle of one
        os.write(sys.__stderr__.fileno() if sys.__stderr__ else 2, NOTICE)
