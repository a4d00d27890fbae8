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
from industnerf.reconstruct.lenses import merged


@dataclass(frozen=True)
class Shot:
    """One frame: its place in the file, the photograph's name, and what is said of its camera."""

    number: int
    name: str  # with forward slashes, without a leading ./
    lens: Mapping[str, Any]
    matrix: Any

    def __str__(self) -> str:
        return f"frame {self.number} ({self.name})"


def read_shots(path: Path, *, every: bool) -> tuple[list[Shot], list[Shot]]:
    """The frames to use, and all that there are; where `train_filenames` is given, only those.

    `every` takes them all.  Raises BadArtifact that names the file, and the frame if one is wrong.
    """
    content = _read(path)
    frames = content.get("frames")
    if not isinstance(frames, list) or not frames:
        raise BadArtifact(f"{path}: `frames` is missing or empty; it must list the photographs")
    shots = [_shot(path, number, content, frame) for number, frame in enumerate(frames)]
    named = content.get("train_filenames")
    if named is None or every:
        return shots, shots
    return _named(path, shots, named), shots


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


def _shot(path: Path, number: int, content: dict[str, Any], frame: Any) -> Shot:
    if not isinstance(frame, dict):
        raise BadArtifact(f"{path}: frame {number} is no object")
    name = frame.get("file_path")
    if not isinstance(name, str) or not plain(name):
        raise BadArtifact(f"{path}: frame {number} has no `file_path`")
    if "transform_matrix" not in frame:
        raise BadArtifact(f"{path}: frame {number} ({name}) has no `transform_matrix`")
    return Shot(number, plain(name), merged(content, frame), frame["transform_matrix"])


def plain(name: str) -> str:
    """`name` with forward slashes and without a leading ./"""
    name = name.replace("\\", "/")
    while name.startswith("./"):
        name = name[2:].lstrip("/")
    return name


def _named(path: Path, shots: Sequence[Shot], names: Any) -> list[Shot]:
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        raise BadArtifact(f"{path}: `train_filenames` must be a list of names")
    wanted = {plain(name) for name in names}
    unknown = sorted(wanted - {shot.name for shot in shots})
    if unknown:
        raise BadArtifact(
            f"{path}: `train_filenames` names {unknown[0]!r}, which no frame has as its "
            "`file_path`; --all takes every frame instead"
        )
    return [shot for shot in shots if shot.name in wanted]
