"""Progress: bars on a terminal, a line every few seconds elsewhere.  Ctrl-C that leaves time."""

import os
import signal
import sys
import time
from types import FrameType, TracebackType

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeRemainingColumn
from rich.progress import Progress as Bar

LOG_INTERVAL_S = 10.0  # between two lines where there is no terminal
MIN_MEASURED_STEPS = 10  # behind the first of a level, before the time that is left is estimated


class Display:
    """One bar a level: its step, its loss, and the time that is left to it."""

    def __init__(self, console: Console) -> None:
        self._console = console
        self._label, self._num_steps, self._num_done = "", 0, 0
        self._first_step_end = self._last_log_time = time.monotonic()
        self._bar = Bar(
            TextColumn("{task.description}"),
            BarColumn(),
            MofNCompleteColumn(),
            TextColumn("{task.fields[loss]}"),
            TimeRemainingColumn(),
            console=console,
            disable=not console.is_terminal,
        )

    def __enter__(self) -> "Display":
        self._bar.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._bar.stop()

    def start_level(self, level: str, steps: int) -> None:
        """A new bar, of `steps`."""
        self._label, self._num_steps, self._num_done = level, steps, 0
        self._task = self._bar.add_task(level, total=steps, loss="")

    def advance(self, loss: float | None = None) -> None:
        """One step of the level that was begun last."""
        self._num_done += 1
        loss_text = "" if loss is None else f"loss {loss:.4g}"
        self._bar.update(self._task, advance=1, loss=loss_text)
        now = time.monotonic()
        if self._num_done == 1:  # it starts the level up too, so it measures nothing
            self._first_step_end = now
        if not self._console.is_terminal and now - self._last_log_time > LOG_INTERVAL_S:
            self._last_log_time = now
            fields = [
                f"{self._label}: {self._num_done} of {self._num_steps}",
                loss_text,
                self._time_left(now),
            ]
            self.log(", ".join(field for field in fields if field))

    def _time_left(self, now: float) -> str:
        """Of this level, by its steps but the first; empty until enough of them are measured."""
        measured = self._num_done - 1
        if measured < MIN_MEASURED_STEPS:
            return ""
        remaining = max(self._num_steps - self._num_done, 0)
        return f"{(now - self._first_step_end) / measured * remaining:.0f} s left"

    def count_images(self, done: int, total: int) -> None:
        """The photographs read so far."""
        if done == 1:
            self.start_level("photographs", total)
        self.advance()

    def log(self, text: str) -> None:
        """A line above the bars."""
        self._console.print(text, markup=False, highlight=False, soft_wrap=True)


NOTICE = b"\ninterrupted: ends at the next checkpoint or when done; Ctrl-C again ends at once\n"


class GracefulInterrupt:
    """While entered, the first Ctrl-C only sets `requested`; the second raises."""

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
