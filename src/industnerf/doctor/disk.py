"""Room on the disk for what params.yaml asks for.

The estimate is deliberately generous for the study as it is.  Measured 2026-11-27 on its 117 parts
and 15 methods: photographs take 0.36 bytes a pixel, with mask and depth; the 1755 clouds, with
pictures and candidates, 2.82 MB in the mean, from 0.6 MB (retrieval) to 8.3 MB (industnerf_plus),
so that a study of only those that fit a field takes more; a part's meshes and truth together
0.9 MB.  Hard links make cache, store and outputs one.
"""

import json
import os
import shlex
import shutil
from collections.abc import Iterable
from pathlib import Path

from industnerf.config import load_params
from industnerf.doctor.cache import objects
from industnerf.doctor.findings import Finding, megabytes
from industnerf.doctor.project_paths import Project, ProjectPaths
from industnerf.schema import Params

PER_PIXEL, PER_CLOUD, PER_PART = 0.4, 3.5e6, 1.0e6  # bytes


def check(paths: ProjectPaths) -> list[Finding]:
    """Free space, and whether it is too little.  Raises BadParams if params.yaml is not right.

    Too little is what cannot hold the rest of the study, even if all that is made can stay.
    Whether it can, only the keys that the stages compute would tell: that is said, not judged.
    """
    total = estimate(paths.root, load_params(paths.root / "params.yaml"))
    stored = _stored_bytes(paths)
    required = max(0, total - stored)
    summary = f"about {megabytes(required)} are still needed"
    if stored:
        summary += f", or {megabytes(total)} if parameters or code changed since the "
        summary += f"{megabytes(stored)} in the store were made"
    return [_finding(paths, path, required, total, summary) for path in (paths.store, paths.root)]


def estimate(root: Path, params: Params) -> int:
    """Bytes that the study of `params` takes when it is finished."""
    views = params.views.count + params.views.held_out
    view_bytes = PER_PIXEL * views * params.views.resolution**2
    source = root / params.parts.path
    files = [source] if source.is_file() else source.rglob("*")
    parts = len(params.parts.select) or sum(path.is_file() for path in files)
    return int(parts * (PER_PART + view_bytes + PER_CLOUD * len(params.methods)))


def _stored_bytes(paths: ProjectPaths) -> int:
    """Bytes of what the study has made so far, of whatever parameters and by whatever code."""
    entries = {
        entry for path in paths.root.glob("data/**/index.json") for entry in _index_entries(path)
    }
    return sum(
        os.stat(os.path.join(folder, name)).st_size
        for entry in entries
        for folder, _, names in os.walk(paths.store / entry)
        for name in names
    )


def _index_entries(index: Path) -> list[str]:
    """Step and key of each result that `index` names; none if it is torn: see `lockfile`."""
    try:
        index_content = json.loads(index.read_text(encoding="utf-8"))
        return [f"{index_content['step']}/{key}" for key in index_content["keys"].values()]
    except (ValueError, KeyError, TypeError):
        return []


def _existing_parent(path: Path) -> Path:
    return next(candidate for candidate in (path, *path.parents) if candidate.exists())


def _free_bytes(path: Path) -> int:
    return shutil.disk_usage(_existing_parent(path)).free


def _finding(paths: ProjectPaths, path: Path, required: int, total: int, summary: str) -> Finding:
    """Whether `need` bytes fit at `path`; a store elsewhere would begin with the `whole`."""
    message = f"{megabytes(_free_bytes(path))} are free, {summary}"
    if _free_bytes(path) >= required:
        return Finding(path, message)
    message += "; free some, or set INDUSTNERF_STORE to a larger disk"
    local_store = paths.root / ".store"
    if path == paths.store and _free_bytes(local_store) >= total:
        return Finding(path, message, f"export INDUSTNERF_STORE={shlex.quote(str(local_store))}")
    if _existing_parent(path).stat().st_dev != paths.root.stat().st_dev:
        return Finding(path, message, is_unfixable=True)
    reclaimable = {
        project: size for project in paths.projects() if (size := _reclaimable_bytes(project))
    }
    if reclaimable:
        message += f"; DVC's cache can give back {megabytes(sum(reclaimable.values()))} at most"
    return Finding(path, message, _gc_command(paths, reclaimable), is_unfixable=True)


def _reclaimable_bytes(project: Project) -> int:
    """The most bytes that go if DVC drops what it does not need: what is linked elsewhere stays."""
    files = (path.stat() for path in objects(project) if path.suffix != ".dir")
    return sum(status.st_size for status in files if status.st_nlink == 1)


def _gc_command(paths: ProjectPaths, projects: Iterable[Project]) -> str:
    """Without what no output of today needs; it asks nothing, and spares the store."""
    folders = (paths.shell_words(project.folder) for project in projects)
    return " && ".join(f"(cd {folder} && dvc gc --workspace --force)" for folder in folders)
