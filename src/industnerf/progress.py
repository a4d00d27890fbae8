"""How far a stage is: on a terminal a bar and what is being made, elsewhere a line now and then."""

import time
from collections.abc import Sequence
from types import TracebackType

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, TaskID, TextColumn, TimeElapsedColumn
from rich.progress import Progress as Bar

from industnerf.runner.base import next_piece
from industnerf.store import Cost

LINES = 5  # of a stage, where nobody looks at a terminal ...
MAX_SILENCE_S = 15.0  # ... and a line more for a part that ends so long after the last line


class Progress:
    """Counts made, reused and failed parts of one stage, and says what each method took.

    `pending` are method, or empty, and part of all that is to be made, by `workers` at a time.
    A stage of no part at all says nothing.
    """

    def __init__(
        self, stage: str, pending: Sequence[tuple[str, str]], reused: int, workers: int
    ) -> None:
        self._stage, self._pending, self._reused, self._workers = stage, pending, reused, workers
        self._made, self._failed, self._peak_mb, self._seconds = 0, 0, 0.0, 0.0
        self._groups = {label: _GroupCosts() for label, _ in pending}
        for label, _ in pending:
            self._groups[label].remaining += 1
        self._console = Console()
        self._is_live = self._console.is_terminal
        self._start = self._last_line = time.perf_counter()
        self._bar = Bar(
            TextColumn("{task.description}"),
            BarColumn(20),
            MofNCompleteColumn(),
            TimeElapsedColumn(),
            console=self._console,
            disable=not self._is_live,
            transient=True,
        )
        self._running: dict[int, TaskID] = {}
        self._waiting = list(range(len(pending)))

    def __enter__(self) -> "Progress":
        self._bar.start()
        # reused parts take no time, so they stay out of the bar
        self._total = self._bar.add_task(self._stage, total=len(self._pending))
        for _ in range(min(self._workers, len(self._pending))):
            self._begin_next(None)
        return self

    def advance(self, index: int, error: str | None, cost: Cost | None) -> None:
        """Count the pending part number `index`; a failure is said at once."""
        label, part_id = self._pending[index]
        seconds = cost.processor_seconds + cost.extra_processor_seconds if cost else 0.0
        peak_mb = cost.peak_mb if cost else 0.0
        self._peak_mb, self._seconds = max(self._peak_mb, peak_mb), self._seconds + seconds
        self._made += error is None
        self._failed += error is not None
        self._bar.update(self._total, advance=1)
        if (task := self._running.pop(index, None)) is not None:
            self._bar.remove_task(task)
        if self._waiting:
            self._begin_next(label)
        name = f"{self._stage} {label}".rstrip()
        if error is not None:
            self._print(f"{name}: {part_id} failed: {error}")
        elif not self._is_live and self._is_due():
            counts = f"{self._made + self._failed} of {len(self._pending)}"
            self._print(f"{name}: {part_id}, {seconds:.1f} processor s, {counts}")
        group = self._groups[label]
        group.add(seconds, peak_mb, is_made=error is None)
        if label and not group.remaining:
            self._print(f"{name}: {group.made} made{_costs_text(group.seconds, group.peak_mb)}")

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._bar.stop()
        if not self._pending and not self._reused:
            return
        outcome = "interrupted" if kind else "done"
        counts = f"{self._made} made, {self._reused} reused, {self._failed} failed"
        seconds = time.perf_counter() - self._start
        costs = _costs_text(self._seconds, self._peak_mb)
        self._print(f"{self._stage}: {outcome}, {counts}, {seconds:.1f} s{costs}")

    def _begin_next(self, own: str | None) -> None:
        """Show what the worker begins that has done a part of the method `own`, as runners do."""
        labels = [label for label, _ in self._pending]
        busy = {labels[i] for i in self._running}
        index = next_piece(self._waiting, labels, own, busy)
        self._waiting.remove(index)
        text = f"  {' '.join(filter(None, self._pending[index]))}"
        self._running[index] = self._bar.add_task(text, total=None)

    def _print(self, text: str) -> None:
        self._console.print(text, markup=False, highlight=False, soft_wrap=True)
        self._last_line = time.perf_counter()

    def _is_due(self) -> bool:
        every = max(1, len(self._pending) // LINES)
        is_silent = time.perf_counter() - self._last_line > MAX_SILENCE_S
        return is_silent or (self._made + self._failed) % every == 0


class _GroupCosts:
    """What the parts of one method took so far, and how many are not yet made."""

    def __init__(self) -> None:
        self.made, self.remaining, self.seconds, self.peak_mb = 0, 0, 0.0, 0.0

    def add(self, seconds: float, peak_mb: float, *, is_made: bool) -> None:
        self.made += is_made
        self.remaining -= 1
        self.seconds += seconds
        self.peak_mb = max(self.peak_mb, peak_mb)


def _costs_text(seconds: float, peak_mb: float) -> str:
    """Such as `, 45.3 processor s, at most 1402 MB a process`; of nothing made it is empty."""
    return f", {seconds:.1f} processor s, at most {peak_mb:.0f} MB a process" if peak_mb else ""
