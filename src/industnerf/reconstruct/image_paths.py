"""The files of photographs: found by the names that camera files give them."""

import os
from collections.abc import Container, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path, PurePosixPath

from industnerf.errors import BadArtifact
from industnerf.reconstruct.camera_files.frames import Frame, name_key

SUFFIXES = (".png", ".jpg", ".jpeg", ".tif", ".tiff", ".webp", ".bmp", ".PNG", ".JPG", ".JPEG")


@dataclass(frozen=True)
class ImageFinder:
    """Looks for files in `folders`, the first of which that holds one says where it is.

    A name may lack its extension, and the folder may be one that the name's own folders lead
    into: `images/7.png` is found in a folder that holds `7.png`, if it holds no `images/7.png`.
    Where no file is spelled like the name, one that differs in case or Unicode form is taken.
    """

    folders: Sequence[Path]
    _listings: dict[Path, dict[str, list[Path]]] = field(default_factory=dict)

    def find(self, name: str, taken: Container[Path] = ()) -> Path | None:
        """The file that `name` means, or None; those that resolve to one of `taken` do not count.

        So a mask, named as its photograph is but in a folder of its own, is not that photograph.
        """
        exact = (path for path in _candidate_paths(name, self.folders) if path.is_file())
        candidates = chain(exact, self._respelled(name))
        return next((path for path in candidates if path.resolve() not in taken), None)

    def all_of(self, name: str) -> list[Path]:
        """Every file that `name` means, or would mean if another did not go before it."""
        exact = [path for path in _candidate_paths(name, self.folders) if path.is_file()]
        return exact or list(self._respelled(name))

    def _respelled(self, name: str) -> Iterator[Path]:
        """Files whose name differs in its spelling alone, where one folder holds just one such."""
        for path in _candidate_paths(name, self.folders):
            if (found := self._respell(path)) and found.is_file():
                yield found

    def _respell(self, path: Path) -> Path | None:
        """`path` as the disk spells it, or None if there is no such, or more than one."""
        if path.exists():
            return path
        if path.parent == path or not path.name:
            return None
        parent = self._respell(path.parent)
        if parent is None:
            return None
        if parent not in self._listings:
            self._listings[parent] = _listing(parent)
        matches = self._listings[parent].get(name_key(path.name), [])
        return matches[0] if len(matches) == 1 else None


def _listing(folder: Path) -> dict[str, list[Path]]:
    """What lies in `folder`, by its name's key."""
    entries: dict[str, list[Path]] = {}
    for path in folder.iterdir() if folder.is_dir() else ():
        entries.setdefault(name_key(path.name), []).append(path)
    return entries


def _candidate_paths(name: str, folders: Sequence[Path]) -> Iterator[Path]:
    parts = PurePosixPath(name).parts
    for folder in folders:
        for num_skipped in range(len(parts)):
            path = folder.joinpath(*parts[num_skipped:])
            yield path
            yield from (Path(f"{path}{suffix}") for suffix in SUFFIXES)


def find_images(frames: Sequence[Frame], finder: ImageFinder) -> list[Path | None]:
    """The file of every frame, None where there is none.

    Raises BadArtifact if two frames share one, or no frame has any.
    """
    paths = [finder.find(frame.name) for frame in frames]
    if not any(paths):
        raise BadArtifact(no_such_photograph(frames[0], finder))
    frame_of_path: dict[Path, Frame] = {}
    for frame, path in zip(frames, paths, strict=True):
        if path is None:
            continue
        first_frame = frame_of_path.setdefault(path.resolve(), frame)
        if first_frame is not frame:
            raise BadArtifact(f"{first_frame} and {frame} are the same photograph, {path}")
    return paths


def no_such_photograph(frame: Frame, finder: ImageFinder) -> str:
    """That the photograph of `frame` is missing, and where it was looked for."""
    searched = " and ".join(str(folder) for folder in finder.folders)
    return f"{frame}: no such photograph in {searched}"


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


def unlisted_images(image_paths: Sequence[Path], protected: Sequence[Path]) -> list[Path]:
    """Images that lie beside `image_paths` and are none of `protected`."""
    known = {path.resolve() for path in protected}
    used_folders = {image_path.parent.resolve() for image_path in image_paths}
    siblings = [path for folder in used_folders for path in folder.iterdir()]
    images = [path for path in siblings if path.suffix in SUFFIXES and path.is_file()]
    return sorted(path for path in images if path.resolve() not in known)


def protected_paths(frames: Sequence[Frame], finder: ImageFinder) -> list[Path]:
    """Every file that is a photograph of `frames`, or would be if another did not go before it.

    A frame that is not used may well have no photograph, but the one that it has is no stranger.
    """
    return [path for frame in frames for path in finder.all_of(frame.name)]
