"""What every reader of a camera file returns: posed photographs, in transforms.json's words."""

import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from industnerf.errors import BadArtifact


@dataclass(frozen=True)
class Frame:
    """One frame: its place in the file, the photograph's name, and what is said of its camera."""

    index: int
    name: str  # with forward slashes, without a leading ./
    camera_params: Mapping[str, Any]  # by the keys of transforms.json: fl_x, w, k1, ...
    matrix: Any  # camera to world with OpenGL's axes, as the file has it
    mask_name: str | None = None

    def __str__(self) -> str:
        return f"frame {self.index} ({self.name})"


@dataclass(frozen=True)
class CameraFile:
    """The frames that a file lists, and where their photographs may be."""

    path: Path
    frames: Sequence[Frame]
    folders: tuple[Path, ...]  # where photographs are looked for, nearest first
    train_names: Sequence[str] | None = None  # of the frames to use; None: all
    poses_before: Float[np.ndarray, "4 4"] | None = None  # to the frame that poses were moved from
    moved_by: str = ""  # what moved them, for a message
    warnings: tuple[str, ...] = ()
    is_colmap: bool = False

    def frames_to_use(self, *, all_frames: bool) -> list[Frame]:
        """Those that `train_names` names, or all.  Raises BadArtifact if it names no frame."""
        if self.train_names is None or all_frames:
            return list(self.frames)
        wanted = {name_key(normalize_path(name)) for name in self.train_names}
        known = {name_key(frame.name) for frame in self.frames}
        for name in self.train_names:
            if name_key(normalize_path(name)) not in known:
                raise BadArtifact(
                    f"{self.path}: `train_filenames` names {normalize_path(name)!r}, which no "
                    "frame has as its `file_path`; --all-frames takes every frame instead"
                )
        return [frame for frame in self.frames if name_key(frame.name) in wanted]


def normalize_path(name: str) -> str:
    """`name` with forward slashes and without a leading ./"""
    name = name.replace("\\", "/")
    while name.startswith("./"):
        name = name[2:].lstrip("/")
    return name


def name_key(name: str) -> str:
    """Equal for two spellings of one name, whatever their case or Unicode form."""
    return unicodedata.normalize("NFC", unicodedata.normalize("NFC", name).casefold())


def list_of_frames(path: Path, content: Any) -> list[Any]:
    """The entries of `frames`; raises BadArtifact if there are none."""
    if not isinstance(content, dict):
        raise BadArtifact(f"{path} holds a {type(content).__name__}, not an object with `frames`")
    entries = content.get("frames")
    if not isinstance(entries, list) or not entries:
        raise BadArtifact(f"{path}: `frames` is missing or empty; it must list the photographs")
    return entries


def name_in(path: Path, index: int, entry: Any, key: str) -> str:
    """The photograph's name under `key`; raises BadArtifact if there is none."""
    if not isinstance(entry, dict):
        raise BadArtifact(f"{path}: frame {index} is no object")
    name = entry.get(key)
    if not isinstance(name, str) or not normalize_path(name):
        raise BadArtifact(f"{path}: frame {index} has no `{key}`")
    return normalize_path(name)


def optional_name(entry: Mapping[str, Any], key: str) -> str | None:
    """A file's name under `key`, if there is one."""
    name = entry.get(key)
    return normalize_path(name) if isinstance(name, str) and normalize_path(name) else None
