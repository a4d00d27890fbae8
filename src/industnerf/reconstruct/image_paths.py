"""Where the photographs are that transforms.json names."""

import os
from collections.abc import Iterator, Sequence
from pathlib import Path, PurePosixPath

from industnerf.errors import BadArtifact
from industnerf.reconstruct.transforms import Frame

SUFFIXES = (".png", ".jpg", ".jpeg", ".tif", ".tiff", ".webp", ".bmp", ".PNG", ".JPG", ".JPEG")


def find_images(frames: Sequence[Frame], folders: Sequence[Path]) -> list[Path]:
    """The file of every shot; raises BadArtifact if one is missing, or two shots share one."""
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
    """Those of `photos` that were not found in `images`; raises BadArtifact if that is all."""
    if images_dir is None:
        return []
    outside = [path for path in image_paths if not _is_inside(path, images_dir)]
    if len(outside) == len(image_paths):
        raise BadArtifact(
            f"--images {images_dir}: none of the {len(image_paths)} photographs is found there, the first "
            f"is {outside[0]}; without --images they are taken from where the cameras are"
        )
    return outside


def _is_inside(path: Path, folder: Path) -> bool:
    """A link in the folder is in it, wherever it leads; `..` leads out."""
    is_inside = Path(os.path.abspath(path)).is_relative_to(os.path.abspath(folder))
    return is_inside or path.resolve().is_relative_to(folder.resolve())


def unlisted_images(
    image_paths: Sequence[Path], frames: Sequence[Frame], folders: Sequence[Path]
) -> list[Path]:
    """Images that lie beside `photos` and belong to none of `shots`, which are all the frames.

    A frame that is not used may well have no photograph, but the one that it has is no stranger.
    """
    protected = {image_path.resolve() for image_path in protected_paths(frames, folders)}
    used_folders = {image_path.parent.resolve() for image_path in image_paths}
    siblings = [path for folder in used_folders for path in folder.iterdir()]
    images = [path for path in siblings if path.suffix in SUFFIXES and path.is_file()]
    return sorted(path for path in images if path.resolve() not in protected)


def protected_paths(frames: Sequence[Frame], folders: Sequence[Path]) -> list[Path]:
    """Every file that is a photograph of `shots`, or would be if another did not go before it."""
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
