"""transforms.json of the NeRF convention, as NeRF, instant-ngp, nerfstudio and this suite write it.

Keys that say nothing of where a camera stands or what its lens does (`aabb_scale`, `orientation`,
`applied_transform`, ...) are ignored.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from industnerf.errors import BadArtifact
from industnerf.reconstruct.camera_models import merge_camera_params


@dataclass(frozen=True)
class Frame:
    """One frame: its place in the file, the photograph's name, and what is said of its camera."""

    index: int
    name: str  # with forward slashes, without a leading ./
    camera_params: Mapping[str, Any]
    matrix: Any

    def __str__(self) -> str:
        return f"frame {self.index} ({self.name})"


def read_frames(path: Path, *, all_frames: bool) -> tuple[list[Frame], list[Frame]]:
    """The frames to use, and all that there are; where `train_filenames` is given, only those.

    `every` takes them all.  Raises BadArtifact that names the file, and the frame if one is wrong.
    """
    content = _read(path)
    entries = content.get("frames")
    if not isinstance(entries, list) or not entries:
        raise BadArtifact(f"{path}: `frames` is missing or empty; it must list the photographs")
    listed_frames = [
        _parse_frame(path, index, content, entry) for index, entry in enumerate(entries)
    ]
    train_names = content.get("train_filenames")
    if train_names is None or all_frames:
        return listed_frames, listed_frames
    return _train_frames(path, listed_frames, train_names), listed_frames


def _read(path: Path) -> dict[str, Any]:
    try:
        content = json.loads(path.read_text(encoding="utf-8-sig"))
    except OSError as error:
        raise BadArtifact(f"{path}: cannot be read: {error.strerror}") from None
    except (ValueError, RecursionError) as error:
        raise BadArtifact(f"{path} is not readable JSON: {error}") from None
    if not isinstance(content, dict):
        raise BadArtifact(f"{path} holds a {type(content).__name__}, not an object with `frames`")
    return content


def _parse_frame(path: Path, index: int, content: dict[str, Any], entry: Any) -> Frame:
    if not isinstance(entry, dict):
        raise BadArtifact(f"{path}: frame {index} is no object")
    name = entry.get("file_path")
    if not isinstance(name, str) or not normalize_path(name):
        raise BadArtifact(f"{path}: frame {index} has no `file_path`")
    if "transform_matrix" not in entry:
        raise BadArtifact(f"{path}: frame {index} ({name}) has no `transform_matrix`")
    return Frame(
        index, normalize_path(name), merge_camera_params(content, entry), entry["transform_matrix"]
    )


def normalize_path(name: str) -> str:
    """`name` with forward slashes and without a leading ./"""
    name = name.replace("\\", "/")
    while name.startswith("./"):
        name = name[2:].lstrip("/")
    return name


def _train_frames(path: Path, frames: Sequence[Frame], names: Any) -> list[Frame]:
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        raise BadArtifact(f"{path}: `train_filenames` must be a list of names")
    wanted = {normalize_path(name) for name in names}
    unknown = sorted(wanted - {frame.name for frame in frames})
    if unknown:
        raise BadArtifact(
            f"{path}: `train_filenames` names {unknown[0]!r}, which no frame has as its "
            "`file_path`; --all-frames takes every frame instead"
        )
    return [frame for frame in frames if frame.name in wanted]
