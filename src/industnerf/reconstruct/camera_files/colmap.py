"""A model of COLMAP: a folder with cameras and images, binary or text.

cameras   id, model, width, height, parameters of the lens
images    id, quaternion (w x y z) and translation from world to camera, camera id, name, points

-- https://colmap.github.io/format.html.  Its axes are OpenCV's, and its pixels begin where ours do.
"""

import struct
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import Rotation

from industnerf.artifacts.views import OPENGL
from industnerf.errors import BadArtifact
from industnerf.reconstruct.camera_files.frames import CameraFile, Frame, normalize_path

ROOM_NAMES = ("cameras", "images", "points3D", "rigs", "frames")  # of the files of a model
# the lenses that are read: their number in a binary file, and the words for their parameters
MODELS = {
    "SIMPLE_PINHOLE": (0, ("f", "cx", "cy")),
    "PINHOLE": (1, ("fl_x", "fl_y", "cx", "cy")),
    "SIMPLE_RADIAL": (2, ("f", "cx", "cy", "k1")),
    "RADIAL": (3, ("f", "cx", "cy", "k1", "k2")),
    "OPENCV": (4, ("fl_x", "fl_y", "cx", "cy", "k1", "k2", "p1", "p2")),
    "FULL_OPENCV": (
        6,
        ("fl_x", "fl_y", "cx", "cy", "k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"),
    ),
}
MODEL_OF_ID = {number: name for name, (number, _) in MODELS.items()}
MAX_ANCESTORS = 3  # folders above a model that may hold its photographs


@dataclass(frozen=True)
class Image:
    """One line of `images`."""

    id: int
    world_to_camera: Float[np.ndarray, "7"]  # quaternion w x y z, translation
    camera_id: int
    name: str


def is_model_file(path: Path) -> bool:
    """Whether `path` is a file of a model, of which all others are beside it."""
    return (
        path.stem in ROOM_NAMES
        and path.suffix in (".bin", ".txt")
        and images_file(path.parent) is not None
    )


def images_file(folder: Path) -> str | None:
    """The name of the list of images in `folder`, if that holds a model; binary goes first."""
    for suffix in (".bin", ".txt"):
        if all((folder / f"{name}{suffix}").is_file() for name in ("cameras", "images")):
            return f"images{suffix}"
    return None


def largest_model(folder: Path) -> Path | None:
    """`folder` if it holds a model, or that of its numbered folders with most images."""
    if images_file(folder):
        return folder
    if not folder.is_dir():
        return None
    models = [child for child in sorted(folder.iterdir()) if child.is_dir() and images_file(child)]
    return max(models, key=lambda model: len(_read_images(model)), default=None)


def read_model(folder: Path) -> CameraFile:
    """The images of the model in `folder`, by name.

    Raises BadArtifact if a file is torn, or a camera has a lens that is not known here.
    """
    path = folder / str(images_file(folder))
    cameras, images = _read_cameras(folder), _read_images(folder)
    if not images:
        raise BadArtifact(f"{path}: no image was registered; the model is empty")
    frames = []
    for index, image in enumerate(sorted(images, key=lambda image: image.name)):
        if image.camera_id not in cameras:
            raise BadArtifact(f"{path}: {image.name} has camera {image.camera_id}, which is none")
        matrix = _camera_to_world(image, path) @ OPENGL
        frames.append(Frame(index, normalize_path(image.name), cameras[image.camera_id], matrix))
    above = [folder, *folder.resolve().parents][: MAX_ANCESTORS + 1]
    folders = tuple(place for parent in above for place in (parent / "images", parent))
    warnings = _other_models(folder, len(images))
    return CameraFile(path, frames, folders, warnings=warnings, is_colmap=True)


def _other_models(folder: Path, num_images: int) -> tuple[str, ...]:
    others = [
        sibling
        for sibling in sorted(folder.resolve().parent.iterdir())
        if sibling.is_dir() and sibling != folder.resolve() and images_file(sibling)
    ]
    if not others or not folder.resolve().name.isdigit():
        return ()
    names = ", ".join(other.name for other in others)
    return (
        f"COLMAP made {1 + len(others)} models that do not join: {folder} with {num_images} images "
        f"is used, and {names} beside it is not",
    )


def _camera_to_world(image: Image, path: Path) -> Float[np.ndarray, "4 4"]:
    quaternion, translation = image.world_to_camera[:4], image.world_to_camera[4:]
    if not np.isfinite(image.world_to_camera).all() or not quaternion.any():
        raise BadArtifact(f"{path}: the pose of {image.name} is not finite, or no rotation")
    c2w = np.eye(4)
    c2w[:3, :3] = Rotation.from_quat(quaternion, scalar_first=True).as_matrix().T
    c2w[:3, 3] = -c2w[:3, :3] @ translation
    return c2w


def _read_cameras(folder: Path) -> dict[int, dict[str, Any]]:
    """The words of transforms.json for each camera, by its id."""
    path = folder / str(images_file(folder)).replace("images", "cameras")
    return _parsed(path, _binary_cameras if path.suffix == ".bin" else _text_cameras)


def _read_images(folder: Path) -> list[Image]:
    path = folder / str(images_file(folder))
    return _parsed(path, _binary_images if path.suffix == ".bin" else _text_images)


def _parsed(path: Path, parse: Callable[[Path], Any]) -> Any:
    try:
        return parse(path)
    except OSError as error:
        raise BadArtifact(f"{path}: cannot be read: {error.strerror}") from None
    except (struct.error, ValueError, IndexError, MemoryError, OverflowError) as error:
        raise BadArtifact(f"{path} is torn, or no file of a COLMAP model: {error}") from None


def _lens(path: Path, model: str, width: int, height: int, values: list[float]) -> dict[str, Any]:
    names = MODELS[model][1]
    if len(values) != len(names):
        raise BadArtifact(f"{path}: a {model} camera has {len(values)} numbers, not {len(names)}")
    params: dict[str, Any] = {"w": width, "h": height} | dict(zip(names, values, strict=True))
    if "f" in params:
        params["fl_x"] = params["fl_y"] = params.pop("f")
    return params


def _unknown_lens(path: Path, model: object) -> BadArtifact:
    return BadArtifact(
        f"{path}: the camera model {model} is not known here, only {', '.join(MODELS)}; undistort "
        f"the photographs: colmap image_undistorter --image_path images --input_path {path.parent} "
        "--output_path undistorted, then give --cameras undistorted/sparse --images "
        "undistorted/images"
    )


def _text_lines(path: Path) -> Iterator[str]:
    return (
        line for line in path.read_text(encoding="utf-8").splitlines() if not line.startswith("#")
    )


def _text_cameras(path: Path) -> dict[int, dict[str, Any]]:
    cameras = {}
    for line in _text_lines(path):
        if not line.strip():
            continue
        number, model, width, height, *values = line.split()
        if model not in MODELS:
            raise _unknown_lens(path, model)
        cameras[int(number)] = _lens(
            path, model, int(width), int(height), [float(value) for value in values]
        )
    return cameras


def _text_images(path: Path) -> list[Image]:
    """Two lines an image, of which the second, its points, may be empty."""
    images, lines = [], _text_lines(path)
    for line in lines:
        if not line.strip():
            continue
        fields = line.split(maxsplit=9)
        pose = np.array([float(field) for field in fields[1:8]])
        images.append(Image(int(fields[0]), pose, int(fields[8]), fields[9].strip()))
        next(lines, None)
    return images


def _unpack(file: BinaryIO, layout: str) -> tuple[Any, ...]:
    return struct.unpack(f"<{layout}", file.read(struct.calcsize(f"<{layout}")))


def _binary_cameras(path: Path) -> dict[int, dict[str, Any]]:
    cameras = {}
    with path.open("rb") as file:
        for _ in range(_unpack(file, "Q")[0]):
            number, model_id, width, height = _unpack(file, "IiQQ")
            if model_id not in MODEL_OF_ID:
                raise _unknown_lens(path, f"number {model_id}")
            model = MODEL_OF_ID[model_id]
            values = list(_unpack(file, f"{len(MODELS[model][1])}d"))
            cameras[number] = _lens(path, model, width, height, values)
    return cameras


def _binary_images(path: Path) -> list[Image]:
    images = []
    with path.open("rb") as file:
        for _ in range(_unpack(file, "Q")[0]):
            number, *pose, camera_id = _unpack(file, "I7dI")
            name = bytearray()
            while (letter := file.read(1)) not in (b"\0", b""):
                name += letter
            (num_points,) = _unpack(file, "Q")
            file.seek(num_points * struct.calcsize("<ddq"), 1)
            images.append(Image(number, np.array(pose), camera_id, name.decode("utf-8")))
    return images
