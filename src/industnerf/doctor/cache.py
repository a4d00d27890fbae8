"""DVC's cache: a file there is called by the MD5 of its content.

DVC trusts its cache: bytes that changed on the disk are handed out, and called up to date.  The
same file may be, by hard links, in the store and among the outputs too, so all of them go.
"""

import hashlib
import re
from collections.abc import Iterator
from pathlib import Path

from industnerf.doctor.findings import Finding
from industnerf.doctor.project_paths import Project, ProjectPaths

OBJECT = re.compile(r"[0-9a-f]{30}(\.dir)?")


def check(paths: ProjectPaths) -> list[Finding]:
    """One finding a damaged file."""
    return [
        _finding(paths, project, path)
        for project in paths.projects()
        for path in objects(project)
        if _md5(path) != path.parent.name + path.name.removesuffix(".dir")
    ]


def objects(project: Project) -> Iterator[Path]:
    """The files in the cache of `project` that have a name as DVC gives it."""
    files = (path for path in sorted(project.cache.glob("??/*")) if path.is_file())
    return (path for path in files if OBJECT.fullmatch(path.name))


def _md5(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "md5").hexdigest()


def _finding(paths: ProjectPaths, project: Project, path: Path) -> Finding:
    copies = sorted({path, *_linked_paths(paths, project, path)})
    num_others = len(copies) - 1
    return Finding(
        path,
        f"its {path.stat().st_size} bytes have another MD5 than its name says: damaged, and DVC "
        f"hands it out all the same; linked to {num_others} other place(s)",
        f"rm -rf {paths.shell_words(*copies)} && {project.rerun_command}",
    )


def _linked_paths(paths: ProjectPaths, project: Project, path: Path) -> Iterator[Path]:
    """Outputs that are the same file, and whole results in the store that hold it."""
    for folder in ("data", "reports"):
        files = (project.folder / folder).rglob("*")
        yield from (file for file in files if file.is_file() and file.samefile(path))
    for file in paths.store.glob("*/*/out/**/*"):
        if file.is_file() and file.samefile(path):
            yield paths.store.joinpath(*file.relative_to(paths.store).parts[:2])
