"""Many small files as one: a zip archive whose members are stored as they are.

    unzip photographs.zip -d folder

makes the folder that other tools read.  DVC, the store and a network file system handle one file
where they handled a hundred.  Equal members in equal order are equal bytes.
"""

import zipfile
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from industnerf.artifacts.files import corrupt_error, missing_error

OLDEST_DATE = (1980, 1, 1, 0, 0, 0)  # that a zip archive can hold: its bytes name no day
UNIX, FILE_MODE = 3, 0o644 << 16


@contextmanager
def write_archive(path: Path) -> Iterator[Callable[[str, bytes], None]]:
    """`add(name, content)` appends a member to the archive `path`, in a folder made for it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(path, "w") as archive:

        def add(name: str, content: bytes) -> None:
            member = zipfile.ZipInfo(name, OLDEST_DATE)
            member.create_system, member.external_attr = UNIX, FILE_MODE
            archive.writestr(member, content)

        yield add


def read_members(path: Path, names: Iterable[str], stage: str) -> list[bytes]:
    """The content of the members `names` of the archive `path`, which `stage` writes.

    Raises BadArtifact that names the file, or the member, if it is missing or torn.
    """
    name, contents = "", []
    try:
        with zipfile.ZipFile(path) as archive:
            for name in names:
                contents.append(archive.read(name))
    except FileNotFoundError:
        raise missing_error(path, stage) from None
    except KeyError:
        raise missing_error(path / name, stage) from None
    except Exception as error:  # of a torn archive zipfile raises whatever its bytes lead to
        raise corrupt_error(path / name, f"cannot be read ({error})", stage) from None
    return contents
