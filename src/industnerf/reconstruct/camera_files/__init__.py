"""Files that say from where photographs were taken: a module a format, one list of frames.

A reader tells its format by content and returns a `CameraFile`, whose frames speak the words of
transforms.json, whatever the file speaks.  What other programs write is named with the way to
convert it.
"""

import json
from pathlib import Path
from typing import Any

from industnerf.errors import BadArtifact
from industnerf.reconstruct.camera_files import colmap, sdfstudio, transforms
from industnerf.reconstruct.camera_files.foreign import refuse_foreign_bytes, refuse_foreign_json
from industnerf.reconstruct.camera_files.frames import CameraFile

SNIFFED_BYTES = 4096
JSON_NAMES = ("transforms.json", "meta_data.json", "transforms_train.json")
MODEL_FOLDERS = (".", "sparse", "colmap/sparse")  # under a folder that is named


def read_camera_file(path: Path) -> CameraFile:
    """The frames of `path`, a file or a folder of any format that is known here.

    Raises BadArtifact that names the format, and the way to convert it, if it is another.
    """
    if path.is_dir():
        path = _file_in_folder(path)
    if colmap.is_model_file(path):
        return colmap.read_model(path.parent)
    try:
        with path.open("rb") as file:
            head = file.read(SNIFFED_BYTES)
    except OSError as error:
        raise BadArtifact(f"{path}: cannot be read: {error.strerror}") from None
    if not head.lstrip(b"\xef\xbb\xbf \t\r\n").startswith((b"{", b"[")):
        refuse_foreign_bytes(path, head)
    content = _read_json(path)
    refuse_foreign_json(path, content)
    if sdfstudio.is_sdfstudio(content):
        return sdfstudio.read(path, content)
    return transforms.read(path, content)


def _read_json(path: Path) -> Any:
    try:
        return json.loads(path.read_text(encoding="utf-8-sig"))
    except OSError as error:
        raise BadArtifact(f"{path}: cannot be read: {error.strerror}") from None
    except (ValueError, RecursionError) as error:
        raise BadArtifact(f"{path} is not readable JSON: {error}") from None


def _file_in_folder(folder: Path) -> Path:
    """What a user means who names the folder of a project, or of a COLMAP model."""
    for name in JSON_NAMES:
        if (folder / name).is_file():
            return folder / name
    for name in MODEL_FOLDERS:
        if model := colmap.largest_model(folder / name):
            return model / colmap.images_file(model)
    raise BadArtifact(
        f"{folder}: is a folder that holds no cameras: none of {', '.join(JSON_NAMES)}, and no "
        "COLMAP model (cameras.bin and images.bin, or the same as .txt) in it or in its sparse/"
    )
