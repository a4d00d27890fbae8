"""The ground truth that methods are scored against: samples of the surface, and the floors."""

from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float32

from industnerf.artifacts.files import read_json, read_npz, write_json

SCHEMA = 2
FLOOR_ERROR = 0.01  # standard error that a floor is to have: relative, or of a share itself


@dataclass(frozen=True)
class Floor:
    """What a perfect method scores: a mean over samples of the true surface."""

    value: float
    standard_error: float


@dataclass(frozen=True)
class Truth:
    """Area-uniform samples of one part's surface."""

    points_mm: Float32[np.ndarray, "n 3"]
    visible: Bool[np.ndarray, "n"]  # to at least one camera of the reference rig
    floors: dict[str, Floor]  # by "metric protocol"

    @property
    def visible_share(self) -> float:
        """Share of the area that the reference rig sees."""
        return float(self.visible.mean())

    def save(self, folder: Path) -> None:
        """Write `samples.npz` and `floors.json` into `folder`."""
        np.savez_compressed(folder / "samples.npz", points_mm=self.points_mm, visible=self.visible)
        write_json(
            folder / "floors.json",
            {
                "schema": SCHEMA,
                "visible_share": self.visible_share,
                "floors": {name: asdict(floor) for name, floor in self.floors.items()},
            },
        )

    @staticmethod
    def load(folder: Path) -> "Truth":
        """Read what `save` wrote; raises BadArtifact if it is missing or torn."""
        floors = read_json(folder / "floors.json", SCHEMA, "truth")["floors"]
        samples = read_npz(folder / "samples.npz", ("points_mm", "visible"), "truth")
        return Truth(*samples, {name: Floor(**floor) for name, floor in floors.items()})
