"""How a method's loss fell on one part."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int

from industnerf.artifacts.files import corrupt_error, read_npz

SCHEMA = 1
FILE = "history.npz"


@dataclass(frozen=True)
class History:
    """The loss at some of the optimization steps."""

    steps: Int[np.ndarray, "n"]  # counted from 0 over all levels, rising
    loss: Float[np.ndarray, "n"]
    levels: dict[str, int]  # name of each stage of the optimization -> its first step

    def save(self, folder: Path) -> None:
        """Write `history.npz` into `folder`."""
        np.savez_compressed(
            folder / FILE,
            schema=SCHEMA,
            steps=self.steps.astype(np.int64),
            loss=self.loss.astype(np.float64),
            names=np.array(list(self.levels), str),
            starts=np.array(list(self.levels.values()), np.int64),
        )

    @staticmethod
    def load(folder: Path, stage: str = "reconstruct") -> "History | None":
        """Read what `save` wrote, None if the method keeps no history.

        `stage` writes it.  Raises BadArtifact if the file is torn or of another schema.
        """
        path = folder / FILE
        if not path.exists():
            return None
        schema, steps, loss, names, starts = read_npz(
            path, ("schema", "steps", "loss", "names", "starts"), stage
        )
        if schema != SCHEMA or steps.shape != loss.shape or names.shape != starts.shape:
            what = f"has schema {schema}, {len(steps)} steps and {len(loss)} losses"
            raise corrupt_error(path, what, stage)
        return History(steps, loss, dict(zip(names.tolist(), starts.tolist(), strict=True)))
