"""A known distance between two points makes millimeters of a frame whose unit is arbitrary."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from industnerf.errors import BadArtifact
from industnerf.reconstruct.camera_files.frames import Frame, name_key
from industnerf.reconstruct.poses import parse_pose

NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
POINT = re.compile(rf"\s*({NUMBER})\s*,\s*({NUMBER})\s*,\s*({NUMBER})\s*")


@dataclass(frozen=True)
class Scale:
    """Two ends, each `x,y,z` or the name of a photograph whose camera is meant, and their distance.

    Points are in the unit of the cameras before they are scaled.
    """

    ends: tuple[str, str]
    distance_mm: float


def scale_factor(
    scale: Scale, frames: Sequence[Frame], to_frame: Float[np.ndarray, "4 4"]
) -> float:
    """mm over the unit of the cameras; `to_frame` moves the poses of `frames` to where points are.

    Raises BadArtifact if an end is none, or both are one.
    """
    first, second = (_position(end, frames, to_frame) for end in scale.ends)
    distance = float(np.linalg.norm(second - first))
    if not distance > 0:
        raise BadArtifact(f"--scale {' '.join(scale.ends)}: both ends are one point")
    return scale.distance_mm / distance


def _position(
    end: str, frames: Sequence[Frame], to_frame: Float[np.ndarray, "4 4"]
) -> Float[np.ndarray, "3"]:
    if match := POINT.fullmatch(end):
        return np.array([float(number) for number in match.groups()])
    frame = find_frame(end, frames)
    if frame is None:
        raise BadArtifact(f"--scale {end}: is neither a point x,y,z nor the name of one photograph")
    c2w, _ = parse_pose(frame.matrix, str(frame))
    return to_frame[:3, :3] @ c2w[:3, 3] + to_frame[:3, 3]


def find_frame(name: str, frames: Sequence[Frame]) -> Frame | None:
    """The frame of that name, or the only one whose last part it is."""
    key = name_key(name.replace("\\", "/").removeprefix("./"))
    same = [frame for frame in frames if name_key(frame.name) == key]
    last = [frame for frame in frames if name_key(frame.name).endswith(f"/{key}")]
    found = same or last
    return found[0] if len(found) == 1 else None
