"""Cameras and photographs in one zip archive, such as the `photographs.zip` of the stage views."""

import lzma
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

from industnerf.errors import BadArtifact
from industnerf.reconstruct.load_images import ImageSet

UNREADABLE = (
    zipfile.BadZipFile,
    zlib.error,
    lzma.LZMAError,
    EOFError,
    OSError,
    RuntimeError,  # encrypted
    NotImplementedError,  # a compression that Python lacks
)


@contextmanager
def unpacked(cameras: Path) -> Iterator[Path]:
    """`cameras`; if that is an archive, a folder with its content for as long as it is entered.

    A BadArtifact that is raised meanwhile names files as if the archive were a folder.  Raises
    BadArtifact if the archive is torn.
    """
    if not _is_archive(cameras):
        yield cameras
        return
    with TemporaryDirectory() as scratch:
        folder = Path(scratch)
        try:
            with zipfile.ZipFile(cameras) as archive:
                archive.extractall(folder)
        except UNREADABLE as error:
            raise BadArtifact(f"{cameras}: cannot be unpacked: {error}") from None
        try:
            yield _top_folder(folder)
        except BadArtifact as error:
            folder = _top_folder(folder)
            raise BadArtifact(str(error).replace(str(folder), str(cameras))) from None


def _is_archive(path: Path) -> bool:
    """Whether it is a zip archive, but not one of arrays: numpy's npz is one too."""
    if not zipfile.is_zipfile(path):
        return False
    try:
        with zipfile.ZipFile(path) as archive:
            return not all(name.endswith(".npy") for name in archive.namelist())
    except zipfile.BadZipFile:
        return True


def _top_folder(folder: Path) -> Path:
    """`folder`, or the folder in it, as long as that is all it holds."""
    entries = [e for e in folder.iterdir() if e.name != "__MACOSX" and not e.name.startswith(".")]
    is_wrapper = len(entries) == 1 and entries[0].is_dir()
    return _top_folder(entries[0]) if is_wrapper else folder


def named_in_archive(image_set: ImageSet, folder: Path, archive: Path) -> ImageSet:
    """`image_set` of the unpacked `folder`, its files named as if `archive` were that folder."""

    def renamed(path: Path) -> Path:
        return archive / path.relative_to(folder) if path.is_relative_to(folder) else path

    return replace(
        image_set,
        image_paths=tuple(map(renamed, image_set.image_paths)),
        protected_paths=(archive, *map(renamed, image_set.protected_paths)),
        warnings=tuple(text.replace(str(folder), str(archive)) for text in image_set.warnings),
    )
