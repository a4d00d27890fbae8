"""The ground truth that methods are scored against: samples of the surface, and the floors."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float32

from industnerf.artifacts.files import read_json, read_npz, write_json

SCHEMA = 1


@dataclass(frozen=True)
class Truth:
    """Area-uniform samples of one part's surface."""

    points_mm: Float32[np.ndarray, "n 3"]
    visible: Bool[np.ndarray, "n"]  # to at least one camera of the reference rig
    floors: dict[str, float]  # "metric protocol" -> value between two samples of the truth

    @property
    def visible_share(self) -> float:
        """Share of the area that the reference rig sees."""
        return float(self.visible.mean())

    def save(self, folder: Path) -> None:
        """Write `samples.npz` and `floors.json` into `folder`."""
        np.savez_compressed(folder / "samples.npz", points_mm=self.points_mm, visible=self.visible)
        write_json(
            folder / "floors.json",
            {"schema": SCHEMA, "visible_share": self.visible_share, "floors": self.floors},
        )

    @staticmethod
    def load(folder: Path) -> "Truth":
        """Read what `save` wrote; raises BadArtifact if it is missing or torn."""
        floors = read_json(folder / "floors.json", SCHEMA, "truth")["floors"]
        return Truth(*read_npz(folder / "samples.npz", ("points_mm", "visible"), "truth"), floors)
