"""How far a run is: bars on a terminal, a line every few seconds elsewhere."""

import time
from types import TracebackType

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeRemainingColumn
from rich.progress import Progress as Bar

QUIET_S = 10.0  # between two lines where there is no terminal


class Display:
    """One bar a level: its step, its loss, and the time that is left to it."""

    def __init__(self, console: Console) -> None:
        self._console = console
        self._level, self._steps, self._done = "", 0, 0
        self._start = self._said = time.monotonic()
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

    def begin(self, level: str, steps: int) -> None:
        """A new bar, of `steps`."""
        self._level, self._steps, self._done = level, steps, 0
        self._start = time.monotonic()
        self._task = self._bar.add_task(level, total=steps, loss="")

    def step(self, loss: float | None = None) -> None:
        """One step of the level that was begun last."""
        self._done += 1
        shown = "" if loss is None else f"loss {loss:.4g}"
        self._bar.update(self._task, advance=1, loss=shown)
        now = time.monotonic()
        if not self._console.is_terminal and now - self._said > QUIET_S:
            self._said = now
            left = (now - self._start) / self._done * max(self._steps - self._done, 0)
            words = [f"{self._level}: {self._done} of {self._steps}", shown, f"{left:.0f} s left"]
            self.say(", ".join(word for word in words if word))

    def count(self, done: int, of: int) -> None:
        """The photographs read so far."""
        if done == 1:
            self.begin("photographs", of)
        self.step()

    def say(self, text: str) -> None:
        """A line above the bars."""
        self._console.print(text, markup=False, highlight=False, soft_wrap=True)
