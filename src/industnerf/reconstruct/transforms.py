"""transforms.json of the NeRF convention, as NeRF, instant-ngp, nerfstudio and this suite write it.

Frames, camera-to-world matrices turned to our axes, and the files of the photographs.  Keys that
say nothing of where a camera stands or what its lens does (`aabb_scale`, `orientation`,
`applied_transform`, ...) are ignored.
"""

import json
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any

import numpy as np
from jaxtyping import Float

from industnerf.artifacts.views import OPENGL
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

    `all_frames` takes them all.  Raises BadArtifact that names file and frame.
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


# of a rotation; files keep six digits or more, a millirad is a pixel at 1000 px
MAX_ORTHOGONALITY_ERROR = 1e-3
MIN_SCALE_DEVIATION = 1e-4  # an enlargement worth a word


def parse_pose(matrix: Any, frame_label: str) -> tuple[Float[np.ndarray, "4 4"], float]:
    """c2w in OpenCV axes, and the scale that its rotation carried.

    A scale changes the length of the camera's axes, hence no ray and no position: it is dropped.
    What is left is replaced by the nearest rotation.  Raises BadArtifact if the matrix is not
    4 x 4 and finite, mirrors, or is off a rotation by more than MAX_ORTHOGONALITY_ERROR.
    """
    c2w = _parse_matrix(matrix, frame_label)
    rotation = c2w[:3, :3]
    determinant = float(np.linalg.det(rotation))
    if determinant <= 0:
        problem = "mirrors space" if determinant < 0 else "is flat"
        raise BadArtifact(
            f"{frame_label}: the rotation of transform_matrix {problem} ({determinant:.3g})"
        )
    scale = determinant ** (1 / 3)
    rotation = rotation / scale
    error = float(np.abs(rotation.T @ rotation - np.eye(3)).max())
    if error > MAX_ORTHOGONALITY_ERROR:
        raise BadArtifact(
            f"{frame_label}: the first three columns of transform_matrix are no rotation: "
            f"off by {error:.2g}, at most {MAX_ORTHOGONALITY_ERROR:g} is rounding"
        )
    u, _, vt = np.linalg.svd(rotation)
    c2w[:3, :3] = u @ vt
    return c2w @ OPENGL, scale


def _parse_matrix(matrix: Any, frame_label: str) -> Float[np.ndarray, "4 4"]:
    try:
        c2w = np.array(matrix, float)
    except (TypeError, ValueError):
        raise BadArtifact(f"{frame_label}: transform_matrix is no matrix of numbers") from None
    except OverflowError:  # JSON's whole numbers have no end
        raise BadArtifact(f"{frame_label}: a number of transform_matrix is above 1e308") from None
    if c2w.shape != (4, 4):
        raise BadArtifact(f"{frame_label}: transform_matrix has shape {c2w.shape}, must be (4, 4)")
    if not np.isfinite(c2w).all():
        raise BadArtifact(f"{frame_label}: transform_matrix is not finite")
    if np.abs(c2w[3] - [0, 0, 0, 1]).max() > 1e-6:
        raise BadArtifact(
            f"{frame_label}: the last row of transform_matrix is {c2w[3].tolist()}, must be 0 0 0 1"
        )
    return c2w


SUFFIXES = (".png", ".jpg", ".jpeg", ".tif", ".tiff", ".webp", ".bmp", ".PNG", ".JPG", ".JPEG")


def find_images(frames: Sequence[Frame], folders: Sequence[Path]) -> list[Path]:
    """The file of every frame; raises BadArtifact if one is missing, or two frames share one."""
    paths = [find_image(frame, folders) for frame in frames]
    frame_of_path: dict[Path, Frame] = {}
    for frame, path in zip(frames, paths, strict=True):
        first_frame = frame_of_path.setdefault(path.resolve(), frame)
        if first_frame is not frame:
            raise BadArtifact(f"{first_frame} and {frame} are the same photograph, {path}")
    return paths


def find_image(frame: Frame, folders: Sequence[Path]) -> Path:
    """The first of `folders` that holds the photograph says where it is.

    The name may lack its extension, and the folder may be one that the name's own folders lead
    into: `images/7.png` is found in a folder that holds `7.png`, if it holds no `images/7.png`.
    """
    if path := _first_existing(frame, folders):
        return path
    searched = " and ".join(str(folder) for folder in folders)
    raise BadArtifact(f"{frame}: no such photograph in {searched}")


def check_images_dir(images_dir: Path | None) -> None:
    """Raise BadArtifact if the folder that the user named is none."""
    if images_dir is not None and not images_dir.is_dir():
        problem = "is no folder" if images_dir.exists() else "does not exist"
        raise BadArtifact(f"--images {images_dir}: {problem}")


def images_outside_dir(image_paths: Sequence[Path], images_dir: Path | None) -> list[Path]:
    """Those of `image_paths` that were outside `images_dir`; raises BadArtifact if that is all."""
    if images_dir is None:
        return []
    outside = [path for path in image_paths if not _is_inside(path, images_dir)]
    if len(outside) == len(image_paths):
        raise BadArtifact(
            f"--images {images_dir}: none of the {len(image_paths)} photographs is found there, "
            f"the first is {outside[0]}; without --images they are taken from where the cameras are"
        )
    return outside


def _is_inside(path: Path, folder: Path) -> bool:
    """A link in the folder is in it, wherever it leads; `..` leads out."""
    is_inside = Path(os.path.abspath(path)).is_relative_to(os.path.abspath(folder))
    return is_inside or path.resolve().is_relative_to(folder.resolve())


def unlisted_images(
    image_paths: Sequence[Path], frames: Sequence[Frame], folders: Sequence[Path]
) -> list[Path]:
    """Images that lie beside `image_paths` and belong to none of `frames`, which are all of them.

    A frame that is not used may well have no photograph, but the one that it has is no stranger.
    """
    protected = {image_path.resolve() for image_path in protected_paths(frames, folders)}
    used_folders = {image_path.parent.resolve() for image_path in image_paths}
    siblings = [path for folder in used_folders for path in folder.iterdir()]
    images = [path for path in siblings if path.suffix in SUFFIXES and path.is_file()]
    return sorted(path for path in images if path.resolve() not in protected)


def protected_paths(frames: Sequence[Frame], folders: Sequence[Path]) -> list[Path]:
    """Every file that is a photograph of `frames`, or would be if another did not go before it."""
    candidates = (path for frame in frames for path in _candidate_paths(frame.name, folders))
    return [path for path in candidates if path.is_file()]


def _first_existing(frame: Frame, folders: Sequence[Path]) -> Path | None:
    return next((path for path in _candidate_paths(frame.name, folders) if path.is_file()), None)


def _candidate_paths(name: str, folders: Sequence[Path]) -> Iterator[Path]:
    parts = PurePosixPath(name).parts
    for folder in folders:
        for num_skipped in range(len(parts)):
            path = folder.joinpath(*parts[num_skipped:])
            yield path
            yield from (Path(f"{path}{suffix}") for suffix in SUFFIXES)
