"""What the method tells while it works, and what is done with it."""

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float32, UInt8
from PIL import Image
from torch import Tensor

from industnerf.artifacts.whole import written_whole
from industnerf.errors import BadArtifact
from industnerf.methods.industnerf.run import Watch
from industnerf.reconstruct.display import Display
from industnerf.reconstruct.interrupt import Interrupt

GAP = 4  # px between the two halves of a preview


class Watching(Watch):
    """Shows progress; keeps a preview and a checkpoint whenever one is due.

    `keep` writes a checkpoint.  After a Ctrl-C one is due at once, and the run ends behind it.
    """

    def __init__(
        self,
        display: Display,
        stop: Interrupt,
        keep: Callable[[dict[str, Any]], None],
        checkpoint_every: float,
        preview: Path,
        preview_every: float,
    ) -> None:
        self._display, self._stop, self._keep = display, stop, keep
        self._preview = preview
        self._next_checkpoint, self._next_preview = Due(checkpoint_every), Due(preview_every)

    def remark(self, text: str) -> None:
        self._display.say(text)

    def begin(self, level: str, steps: int) -> None:
        self._display.begin(level, steps)

    def step(self, loss: Float32[Tensor, ""]) -> None:
        self._display.step(loss.item())

    def wants_preview(self) -> bool:
        return self._next_preview.passed()

    def preview(
        self, source: UInt8[np.ndarray, "h w 3"], rendered: UInt8[np.ndarray, "h w 3"]
    ) -> None:
        self._try(lambda: write_preview(self._preview, source, rendered))
        self._next_preview.restart()

    def wants_checkpoint(self) -> bool:
        return self._stop.asked or self._next_checkpoint.passed()

    def checkpoint(self, state: dict[str, Any]) -> None:
        self._try(lambda: self._keep(state))
        if self._stop.asked:
            raise KeyboardInterrupt
        self._next_checkpoint.restart()

    def _try(self, write: Callable[[], None]) -> None:
        """A full disk may be mended before the run ends; the run is worth more than its trail."""
        try:
            write()
        except BadArtifact as error:
            self._display.say(f"going on without: {error}")


class Due:
    """Passes `every` seconds after it was restarted; never, if that is 0."""

    def __init__(self, every: float) -> None:
        self._every = every
        self.restart()

    def passed(self) -> bool:
        return 0 < self._every <= time.monotonic() - self._since

    def restart(self) -> None:
        self._since = time.monotonic()


def write_preview(
    path: Path, source: UInt8[np.ndarray, "h w 3"], rendered: UInt8[np.ndarray, "h w 3"]
) -> None:
    """Write the photograph and its re-rendering side by side."""
    gap = np.zeros((len(source), GAP, 3), np.uint8)
    with written_whole(path) as draft:
        Image.fromarray(np.hstack([source, gap, rendered])).save(draft, "PNG")
