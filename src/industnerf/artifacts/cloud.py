"""A reconstructed point cloud in the part's frame."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float, Float32, Int16, UInt8

from industnerf.artifacts.files import read_json, read_npz, spoilt, write_json
from industnerf.artifacts.ply import write_ply

SCHEMA = 2
OTHERS, REMARKS = "others.npz", "remarks.json"


@dataclass(frozen=True)
class Cloud:
    """Points on the part's surface, and what the method says of each."""

    part_id: str
    points_mm: Float32[np.ndarray, "n 3"]
    colours: UInt8[np.ndarray, "n 3"]
    confidence: Float32[np.ndarray, "n"]  # in [0, 1]; 1 = certainly surface
    view: Int16[np.ndarray, "n"]  # the training view that says most of the point; -1 unknown
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
            view=self.view,
        )

    @staticmethod
    def load(folder: Path) -> "Cloud":
        """Read `cloud.npz`; raises BadArtifact if it is missing or of another schema."""
        path, names = folder / "cloud.npz", ("schema", *Cloud.__dataclass_fields__)
        schema, part_id, *arrays, parameters, steps = read_npz(path, names, "reconstruct")
        if schema != SCHEMA:
            what = f"has schema {schema}, this code reads {SCHEMA}"
            raise spoilt(path, what, "reconstruct")
        return Cloud(str(part_id), *arrays, int(parameters), int(steps))

    @staticmethod
    def training(folder: Path) -> tuple[int, int]:
        """`parameters` and `steps` of the cloud in `folder`, without reading its points."""
        parameters, steps = read_npz(folder / "cloud.npz", ("parameters", "steps"), "reconstruct")
        return int(parameters), int(steps)


def save_others(folder: Path, clouds: Sequence[Float[np.ndarray, "_ 3"]]) -> None:
    """Write further answers (mm) beside the cloud in `folder`; one may be empty."""
    ends = np.cumsum([len(points) for points in clouds])
    points = np.concatenate(clouds).astype(np.float32)
    np.savez_compressed(folder / OTHERS, points_mm=points, ends=ends)


def load_others(folder: Path) -> list[Float32[np.ndarray, "_ 3"]]:
    """What `save_others` wrote, none if there are none; raises BadArtifact if the file is torn."""
    if not (folder / OTHERS).exists():
        return []
    points, ends = read_npz(folder / OTHERS, ("points_mm", "ends"), "reconstruct")
    return np.split(points, ends[:-1])


def save_remarks(folder: Path, remarks: Sequence[str]) -> None:
    """Write beside the cloud in `folder` what its method had to say of what it was given."""
    write_json(folder / REMARKS, {"schema": 1, "remarks": remarks})


def load_remarks(folder: Path) -> list[str]:
    """What `save_remarks` wrote, none if there is none; raises BadArtifact if the file is torn."""
    path = folder / REMARKS
    return read_json(path, 1, "reconstruct")["remarks"] if path.exists() else []


def files_of_cloud(folder: Path) -> tuple[Path, ...]:
    """What a score of the cloud in `folder` depends on."""
    others = folder / OTHERS
    return (folder / "cloud.npz", *([others] if others.exists() else []))
