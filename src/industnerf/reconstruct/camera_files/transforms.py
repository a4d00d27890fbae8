"""transforms.json of the NeRF convention, as NeRF, instant-ngp, nerfstudio and this suite write it.

Keys that say nothing of where a camera stands or what its lens does (`aabb_scale`, ...) are
ignored.  Where nerfstudio moved the poses, x became `applied_scale` * `applied_transform` x.
"""

from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from industnerf.errors import BadArtifact
from industnerf.reconstruct.camera_files.frames import (
    CameraFile,
    Frame,
    list_of_frames,
    name_in,
    optional_name,
)
from industnerf.reconstruct.camera_models import merge_camera_params
from industnerf.reconstruct.poses import matrix_4x4


def read(path: Path, content: Any) -> CameraFile:
    """Raises BadArtifact that names file and frame."""
    entries = list_of_frames(path, content)
    train_names = content.get("train_filenames")
    if train_names is not None and not (
        isinstance(train_names, list) and all(isinstance(name, str) for name in train_names)
    ):
        raise BadArtifact(f"{path}: `train_filenames` must be a list of names")
    poses_before, moved_by = _applied_transform(path, content)
    return CameraFile(
        path,
        [_frame(path, index, content, entry) for index, entry in enumerate(entries)],
        (path.parent,),
        train_names,
        poses_before,
        moved_by,
    )


def _frame(path: Path, index: int, content: dict[str, Any], entry: Any) -> Frame:
    name = name_in(path, index, entry, "file_path")
    if "transform_matrix" not in entry:
        raise BadArtifact(f"{path}: frame {index} ({name}) has no `transform_matrix`")
    return Frame(
        index,
        name,
        merge_camera_params(content, entry),
        entry["transform_matrix"],
        optional_name(entry, "mask_path"),
    )


def _applied_transform(
    path: Path, content: dict[str, Any]
) -> tuple[Float[np.ndarray, "4 4"] | None, str]:
    """The way back from `applied_transform` and `applied_scale`, and what the file says of them."""
    scale, applied, names = content.get("applied_scale"), np.eye(4), []
    if content.get("applied_transform") is not None:
        applied = matrix_4x4(content["applied_transform"], f"{path}: applied_transform")
        names.append("applied_transform")
    if scale is not None:
        if isinstance(scale, bool) or not isinstance(scale, int | float) or not 0 < scale < 1e300:
            raise BadArtifact(f"{path}: applied_scale is {scale!r}, must be a number above 0")
        applied = np.diag([scale, scale, scale, 1.0]) @ applied
        names.append(f"applied_scale {scale:g}")
    if np.array_equal(applied, np.eye(4)):
        return None, ""
    if not abs(np.linalg.det(applied)) > 0:
        raise BadArtifact(f"{path}: applied_transform has no inverse")
    return np.linalg.inv(applied), " and ".join(names)
