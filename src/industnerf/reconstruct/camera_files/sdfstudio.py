"""meta_data.json of sdfstudio: OpenCV axes, and `worldtogt` back to the frame of the truth."""

from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from industnerf.artifacts.views import OPENGL
from industnerf.errors import BadArtifact
from industnerf.reconstruct.camera_files.frames import (
    CameraFile,
    Frame,
    list_of_frames,
    name_in,
    optional_name,
)
from industnerf.reconstruct.poses import matrix_4x4


def is_sdfstudio(content: Any) -> bool:
    """Whether a frame has sdfstudio's `camtoworld`, or its `rgb_path`, and not NeRF's keys."""
    entries = content.get("frames") if isinstance(content, dict) else None
    first = entries[0] if isinstance(entries, list) and entries else None
    return (
        isinstance(first, dict)
        and "file_path" not in first
        and not {
            "camtoworld",
            "rgb_path",
        }.isdisjoint(first)
    )


def read(path: Path, content: dict[str, Any]) -> CameraFile:
    """Raises BadArtifact that names file and frame."""
    frames = [
        _frame(path, index, content, entry)
        for index, entry in enumerate(list_of_frames(path, content))
    ]
    poses_before = None
    if content.get("worldtogt") is not None:
        poses_before = matrix_4x4(content["worldtogt"], f"{path}: worldtogt")
    if poses_before is not None and np.array_equal(poses_before, np.eye(4)):
        poses_before = None
    folders = (path.parent, path.parent / "images", path.parent / "image")
    return CameraFile(path, frames, folders, None, poses_before, "worldtogt")


def _frame(path: Path, index: int, content: dict[str, Any], entry: Any) -> Frame:
    name = name_in(path, index, entry, "rgb_path")
    label = f"{path}: frame {index} ({name})"
    for key in ("camtoworld", "intrinsics"):
        if key not in entry:
            raise BadArtifact(f"{label} has no `{key}`")
    c2w = matrix_4x4(entry["camtoworld"], f"{label}: camtoworld")
    params = _lens(entry["intrinsics"], label)
    size = {"w": content.get("width"), "h": content.get("height")}
    params |= {key: value for key, value in size.items() if value is not None}
    return Frame(index, name, params, c2w @ OPENGL, optional_name(entry, "foreground_mask"))


def _lens(intrinsics: Any, label: str) -> dict[str, float]:
    try:
        K: Float[np.ndarray, "rows columns"] = np.array(intrinsics, float)[:3, :3]
    except (TypeError, ValueError, IndexError, OverflowError):
        raise BadArtifact(f"{label}: intrinsics is no matrix of numbers") from None
    if K.shape != (3, 3) or abs(K[0, 1]) > 1e-6 * abs(K[0, 0]):
        raise BadArtifact(f"{label}: intrinsics must be 3 x 3 or 4 x 4, without skew")
    values = {"fl_x": K[0, 0], "fl_y": K[1, 1], "cx": K[0, 2], "cy": K[1, 2]}
    return {key: float(value) for key, value in values.items()}
