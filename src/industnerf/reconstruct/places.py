"""Where the photographs are that transforms.json names."""

import os
from collections.abc import Iterator, Sequence
from pathlib import Path, PurePosixPath

from industnerf.errors import BadArtifact
from industnerf.reconstruct.transforms import Shot

SUFFIXES = (".png", ".jpg", ".jpeg", ".tif", ".tiff", ".webp", ".bmp", ".PNG", ".JPG", ".JPEG")


def find_photos(shots: Sequence[Shot], folders: Sequence[Path]) -> list[Path]:
    """The file of every shot; raises BadArtifact if one is missing, or two shots share one."""
    photos = [find_photo(shot, folders) for shot in shots]
    owners: dict[Path, Shot] = {}
    for shot, photo in zip(shots, photos, strict=True):
        first = owners.setdefault(photo.resolve(), shot)
        if first is not shot:
            raise BadArtifact(f"{first} and {shot} are the same photograph, {photo}")
    return photos


def find_photo(shot: Shot, folders: Sequence[Path]) -> Path:
    """The first of `folders` that holds the photograph says where it is.

    The name may lack its extension, and the folder may be one that the name's own folders lead
    into: `images/7.png` is found in a folder that holds `7.png`, if it holds no `images/7.png`.
    """
    if found := _found(shot, folders):
        return found
    looked = " and ".join(str(folder) for folder in folders)
    raise BadArtifact(f"{shot}: no such photograph in {looked}")


def check_images(images: Path | None) -> None:
    """Raise BadArtifact if the folder that the user named is none."""
    if images is not None and not images.is_dir():
        word = "is no folder" if images.exists() else "does not exist"
        raise BadArtifact(f"--images {images}: {word}")


def elsewhere(photos: Sequence[Path], images: Path | None) -> list[Path]:
    """Those of `photos` that were not found in `images`; raises BadArtifact if that is all."""
    if images is None:
        return []
    strays = [photo for photo in photos if not _lies_in(photo, images)]
    if len(strays) == len(photos):
        raise BadArtifact(
            f"--images {images}: none of the {len(photos)} photographs is found there, the first "
            f"is {strays[0]}; without --images they are taken from where the cameras are"
        )
    return strays


def _lies_in(photo: Path, folder: Path) -> bool:
    """A link in the folder is in it, wherever it leads; `..` leads out."""
    inside = Path(os.path.abspath(photo)).is_relative_to(os.path.abspath(folder))
    return inside or photo.resolve().is_relative_to(folder.resolve())


def unnamed(photos: Sequence[Path], shots: Sequence[Shot], folders: Sequence[Path]) -> list[Path]:
    """Images that lie beside `photos` and belong to none of `shots`, which are all the frames.

    A frame that is not used may well have no photograph, but the one that it has is no stranger.
    """
    ours = {photo.resolve() for photo in owned(shots, folders)}
    folders_used = {photo.parent.resolve() for photo in photos}
    beside = [path for folder in folders_used for path in folder.iterdir()]
    images = [path for path in beside if path.suffix in SUFFIXES and path.is_file()]
    return sorted(path for path in images if path.resolve() not in ours)


def owned(shots: Sequence[Shot], folders: Sequence[Path]) -> list[Path]:
    """Every file that is a photograph of `shots`, or would be if another did not go before it."""
    places = (place for shot in shots for place in _places(shot.name, folders))
    return [place for place in places if place.is_file()]


def _found(shot: Shot, folders: Sequence[Path]) -> Path | None:
    return next((place for place in _places(shot.name, folders) if place.is_file()), None)


def _places(name: str, folders: Sequence[Path]) -> Iterator[Path]:
    parts = PurePosixPath(name).parts
    for folder in folders:
        for skipped in range(len(parts)):
            place = folder.joinpath(*parts[skipped:])
            yield place
            yield from (Path(f"{place}{suffix}") for suffix in SUFFIXES)
