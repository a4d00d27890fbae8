"""Archives as folders, for tests that look at their members or change them."""

import shutil
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from industnerf.artifacts.archive import write_archive


def members(archive: Path) -> dict[str, bytes]:
    """The content of every member, by its name."""
    with zipfile.ZipFile(archive) as opened_archive:
        return {name: opened_archive.read(name) for name in opened_archive.namelist()}


@contextmanager
def opened(archive: Path) -> Iterator[Path]:
    """The members as files of a folder; what is written or removed there is so in the archive."""
    folder = archive.with_suffix("")
    with zipfile.ZipFile(archive) as opened_archive:
        opened_archive.extractall(folder)
    yield folder
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    with write_archive(archive) as add:
        for path in files:
            add(path.relative_to(folder).as_posix(), path.read_bytes())
    shutil.rmtree(folder)
