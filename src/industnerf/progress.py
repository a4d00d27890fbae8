"""How far a stage is: a bar on a terminal, a line every few parts elsewhere."""

import time
from types import TracebackType

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeRemainingColumn
from rich.progress import Progress as Bar

from industnerf.store import Cost


class Progress:
    """Counts done, reused and failed parts of one stage."""

    def __init__(self, stage: str, name: str, total: int, reused: int) -> None:
        self._label = stage if name == stage else f"{stage} {name}"
        self._total, self._reused, self._done, self._failed = total, reused, 0, 0
        self._peak_mb = 0.0
        self._console = Console()
        self._start = time.perf_counter()
        self._bar = Bar(
            TextColumn("{task.description}"),
            BarColumn(),
            MofNCompleteColumn(),
            TextColumn("{task.fields[note]}"),
            TimeRemainingColumn(),
            console=self._console,
            disable=not self._console.is_terminal,
        )

    def __enter__(self) -> "Progress":
        self._bar.start()
        # reused parts take no time, so they stay out of the bar that foretells the end
        self._task = self._bar.add_task(
            self._label, total=self._total - self._reused, note=self._counts_text()
        )
        return self

    def advance(self, part_id: str, error: str | None, cost: Cost | None) -> None:
        """Count one part; a failure is said at once."""
        self._peak_mb = max(self._peak_mb, cost.peak_mb if cost else 0.0)
        self._done += error is None
        self._failed += error is not None
        self._bar.update(self._task, advance=1, note=self._counts_text())
        if error is not None:
            self._console.print(f"{self._label}: {part_id} failed: {error}", markup=False)
        elif not self._console.is_terminal and self._is_due():
            self._console.print(f"{self._label}: {self._counts_text()} of {self._total}")

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._bar.stop()
        seconds = time.perf_counter() - self._start
        outcome = "interrupted" if kind else "done"
        memory = f", at most {self._peak_mb:.0f} MB a process" if self._peak_mb else ""
        self._console.print(
            f"{self._label}: {outcome}, {self._counts_text()}, {seconds:.1f} s{memory}"
        )

    def _counts_text(self) -> str:
        return f"{self._done} made, {self._reused} reused, {self._failed} failed"

    def _is_due(self) -> bool:
        every = max(1, (self._total - self._reused) // 5)
        return (self._done + self._failed) % every == 0
