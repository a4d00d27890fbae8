"""Every point of a method's cloud before it was filtered, by which its confidence is evaluated."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float32

from industnerf.artifacts.files import corrupt_error, read_npz

SCHEMA = 1
FILE = "candidates.npz"


@dataclass(frozen=True)
class Candidates:
    """The points whose density is above 0."""

    points_mm: Float32[np.ndarray, "n 3"]
    confidence: Float32[np.ndarray, "n"]  # in [0, 1]; 1 = certainly surface

    def __len__(self) -> int:
        return len(self.points_mm)

    def save(self, cloud: Path) -> None:
        """Write `candidates.npz` into the folder `cloud`."""
        np.savez_compressed(cloud / FILE, schema=SCHEMA, **vars(self))

    @staticmethod
    def load(cloud: Path) -> "Candidates | None":
        """Read what `save` wrote, None if the method keeps no candidates.

        Raises BadArtifact if the file is torn or of another schema.
        """
        path = cloud / FILE
        if not path.exists():
            return None
        schema, points, confidence = read_npz(
            path, ("schema", "points_mm", "confidence"), "reconstruct"
        )
        if schema != SCHEMA or points.shape != (len(confidence), 3):
            what = f"has schema {schema} and shapes {points.shape} and {confidence.shape}"
            raise corrupt_error(path, what, "reconstruct")
        return Candidates(points, confidence)
