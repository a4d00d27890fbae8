"""What the method tells while it works, and what is done with it."""

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float32, UInt8
from PIL import Image
from torch import Tensor

from industnerf.artifacts.files import atomic_write
from industnerf.errors import BadArtifact
from industnerf.methods.industnerf.pipeline import Callback
from industnerf.reconstruct.display import Display
from industnerf.reconstruct.signal_handling import GracefulInterrupt

PREVIEW_GAP_PX = 4  # px between the two halves of a preview


class CliCallback(Callback):
    """Shows progress; keeps a preview and a checkpoint whenever one is due.

    `keep` writes a checkpoint.  After a Ctrl-C one is due at once, and the run ends behind it.
    """

    def __init__(
        self,
        display: Display,
        interrupt: GracefulInterrupt,
        save_checkpoint: Callable[[dict[str, Any]], None],
        checkpoint_every: float,
        preview: Path,
        preview_every: float,
    ) -> None:
        self._display, self._interrupt, self._save_checkpoint = display, interrupt, save_checkpoint
        self._preview_path = preview
        self._checkpoint_timer, self._preview_timer = Timer(checkpoint_every), Timer(preview_every)

    def on_warning(self, text: str) -> None:
        self._display.log(text)

    def on_level_start(self, level: str, steps: int) -> None:
        self._display.start_level(level, steps)

    def on_step_end(self, loss: Float32[Tensor, ""]) -> None:
        self._display.advance(loss.item())

    def wants_preview(self) -> bool:
        return self._preview_timer.is_due()

    def on_preview(
        self, source: UInt8[np.ndarray, "h w 3"], rendered: UInt8[np.ndarray, "h w 3"]
    ) -> None:
        self._try_write(lambda: write_preview(self._preview_path, source, rendered))
        self._preview_timer.restart()

    def wants_checkpoint(self) -> bool:
        return self._interrupt.requested or self._checkpoint_timer.is_due()

    def on_checkpoint(self, state: dict[str, Any]) -> None:
        self._try_write(lambda: self._save_checkpoint(state))
        if self._interrupt.requested:
            raise KeyboardInterrupt
        self._checkpoint_timer.restart()

    def _try_write(self, write: Callable[[], None]) -> None:
        """A full disk may be mended before the run ends; the run is worth more than its trail."""
        try:
            write()
        except BadArtifact as error:
            self._display.log(f"going on without: {error}")


class Timer:
    """Passes `every` seconds after it was restarted; never, if that is 0."""

    def __init__(self, interval_s: float) -> None:
        self._interval_s = interval_s
        self.restart()

    def is_due(self) -> bool:
        return 0 < self._interval_s <= time.monotonic() - self._start

    def restart(self) -> None:
        self._start = time.monotonic()


def write_preview(
    path: Path, source: UInt8[np.ndarray, "h w 3"], rendered: UInt8[np.ndarray, "h w 3"]
) -> None:
    """Write the photograph and its re-rendering side by side."""
    gap = np.zeros((len(source), PREVIEW_GAP_PX, 3), np.uint8)
    with atomic_write(path) as draft:
        Image.fromarray(np.hstack([source, gap, rendered])).save(draft, "PNG")
