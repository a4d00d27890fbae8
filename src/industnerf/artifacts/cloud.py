"""A reconstructed point cloud in the part's frame."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float32, UInt8

from industnerf.artifacts.files import read_npz
from industnerf.artifacts.ply import write_ply
from industnerf.errors import BadArtifact

SCHEMA = 1


@dataclass(frozen=True)
class Cloud:
    """Points on the part's surface, and what the method says of each."""

    part_id: str
    points_mm: Float32[np.ndarray, "n 3"]
    colours: UInt8[np.ndarray, "n 3"]
    confidence: Float32[np.ndarray, "n"]  # in [0, 1]; 1 = certainly surface
    parameters: int  # trained numbers, 0 where nothing is trained
    steps: int  # optimisation steps taken for this part

    def save(self, folder: Path) -> None:
        """Write `cloud.npz` and, for viewers, `cloud.ply` into `folder`."""
        np.savez_compressed(folder / "cloud.npz", schema=SCHEMA, **vars(self))
        write_ply(
            folder / "cloud.ply",
            self.points_mm,
            colours=self.colours,
            confidence=self.confidence,
        )

    @staticmethod
    def load(folder: Path) -> "Cloud":
        """Read `cloud.npz`; raises BadArtifact if it is missing or of another schema."""
        path, names = folder / "cloud.npz", ("schema", *Cloud.__dataclass_fields__)
        schema, part_id, points, colours, confidence, *training = read_npz(
            path, names, "reconstruct"
        )
        if schema != SCHEMA:
            raise BadArtifact(
                f"{path} has schema {schema}, this code reads {SCHEMA}; "
                "`dvc repro -f reconstruct` writes it anew."
            )
        return Cloud(str(part_id), points, colours, confidence, *map(int, training))

    @staticmethod
    def training(folder: Path) -> tuple[int, int]:
        """`parameters` and `steps` of the cloud in `folder`, without reading its points."""
        parameters, steps = read_npz(folder / "cloud.npz", ("parameters", "steps"), "reconstruct")
        return int(parameters), int(steps)
