"""A reconstructed point cloud in the part's frame."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float, Float32, Int16, UInt8

from industnerf.artifacts.files import corrupt_error, read_json, read_npz, write_json
from industnerf.artifacts.ply import write_ply

SCHEMA = 3
EXTRA_CLOUDS, WARNINGS = "extra_clouds.npz", "warnings.json"


@dataclass(frozen=True)
class Cloud:
    """Points on the part's surface, with color, confidence and source view."""

    part_id: str
    points_mm: Float32[np.ndarray, "n 3"]
    colors: UInt8[np.ndarray, "n 3"]
    confidence: Float32[np.ndarray, "n"]  # in [0, 1]; 1 = certainly surface
    view: Int16[np.ndarray, "n"]  # the training view that weighs most in the point; -1 unknown
    num_parameters: int  # trained numbers, 0 where nothing is trained
    steps: int  # optimization steps taken for this part

    def save(self, folder: Path) -> None:
        """Write `cloud.npz` and, for viewers, `cloud.ply` into `folder`."""
        np.savez_compressed(folder / "cloud.npz", schema=SCHEMA, **vars(self))
        write_ply(
            folder / "cloud.ply",
            self.points_mm,
            colors=self.colors,
            confidence=self.confidence,
            view=self.view,
        )

    @staticmethod
    def load(folder: Path) -> "Cloud":
        """Read `cloud.npz`; raises BadArtifact if it is missing or of another schema."""
        path, names = folder / "cloud.npz", ("schema", *Cloud.__dataclass_fields__)
        schema, part_id, *arrays, num_parameters, steps = read_npz(path, names, "reconstruct")
        if schema != SCHEMA:
            what = f"has schema {schema}, this code reads {SCHEMA}"
            raise corrupt_error(path, what, "reconstruct")
        return Cloud(str(part_id), *arrays, int(num_parameters), int(steps))

    @staticmethod
    def load_training_stats(folder: Path) -> tuple[int, int]:
        """`num_parameters` and `steps` of the cloud in `folder`, without reading its points."""
        names = ("num_parameters", "steps")
        num_parameters, steps = read_npz(folder / "cloud.npz", names, "reconstruct")
        return int(num_parameters), int(steps)


def save_extra_clouds(folder: Path, clouds: Sequence[Float[np.ndarray, "_ 3"]]) -> None:
    """Write further predictions (mm) beside the cloud in `folder`; one may be empty."""
    ends = np.cumsum([len(points) for points in clouds])
    points = np.concatenate(clouds).astype(np.float32)
    np.savez_compressed(folder / EXTRA_CLOUDS, points_mm=points, ends=ends)


def load_extra_clouds(folder: Path) -> list[Float32[np.ndarray, "_ 3"]]:
    """What `save_extra_clouds` wrote, maybe nothing; raises BadArtifact if the file is torn."""
    if not (folder / EXTRA_CLOUDS).exists():
        return []
    points, ends = read_npz(folder / EXTRA_CLOUDS, ("points_mm", "ends"), "reconstruct")
    return np.split(points, ends[:-1])


def save_warnings(folder: Path, warnings: Sequence[str]) -> None:
    """Write the method's warnings about its inputs beside the cloud in `folder`."""
    write_json(folder / WARNINGS, {"schema": 1, "warnings": warnings})


def load_warnings(folder: Path) -> list[str]:
    """What `save_warnings` wrote, maybe nothing; raises BadArtifact if the file is torn."""
    path = folder / WARNINGS
    return read_json(path, 1, "reconstruct")["warnings"] if path.exists() else []


def cloud_files(folder: Path) -> tuple[Path, ...]:
    """What a score of the cloud in `folder` depends on."""
    extra_clouds = folder / EXTRA_CLOUDS
    return (folder / "cloud.npz", *([extra_clouds] if extra_clouds.exists() else []))
