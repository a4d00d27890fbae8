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
from industnerf.doctor.places import Places, Project
from industnerf.schema import Params

PER_PIXEL, PER_CLOUD, PER_PART = 0.4, 3.5e6, 1.0e6  # bytes


def find(places: Places) -> list[Finding]:
    """Free space, and whether it is too little.  Raises BadParams if params.yaml is not right.

    Too little is what cannot hold the rest of the study, even if all that is made can stay.
    Whether it can, only the keys that the stages compute would tell: that is said, not judged.
    """
    whole, held = estimate(places.root, load_params(places.root / "params.yaml")), _held(places)
    need = max(0, whole - held)
    said = f"about {megabytes(need)} are still needed"
    if held:
        said += f", or {megabytes(whole)} if parameters or code changed since the "
        said += f"{megabytes(held)} in the store were made"
    return [_finding(places, path, need, whole, said) for path in (places.store, places.root)]


def estimate(root: Path, params: Params) -> int:
    """Bytes that the study of `params` takes when it is finished."""
    views = params.views.count + params.views.held_out
    photographs = PER_PIXEL * views * params.views.resolution**2
    source = root / params.parts.path
    files = [source] if source.is_file() else source.rglob("*")
    parts = len(params.parts.select) or sum(path.is_file() for path in files)
    return int(parts * (PER_PART + photographs + PER_CLOUD * len(params.methods)))


def _held(places: Places) -> int:
    """Bytes of what the study has made so far, of whatever parameters and by whatever code."""
    made = {entry for path in places.root.glob("data/**/index.json") for entry in _entries(path)}
    return sum(
        os.stat(os.path.join(folder, name)).st_size
        for entry in made
        for folder, _, names in os.walk(places.store / entry)
        for name in names
    )


def _entries(index: Path) -> list[str]:
    """Step and key of each result that `index` names; none if it is torn: see `lockfile`."""
    try:
        made = json.loads(index.read_text(encoding="utf-8"))
        return [f"{made['step']}/{key}" for key in made["keys"].values()]
    except (ValueError, KeyError, TypeError):
        return []


def _existing(path: Path) -> Path:
    return next(each for each in (path, *path.parents) if each.exists())


def _free(path: Path) -> int:
    return shutil.disk_usage(_existing(path)).free


def _finding(places: Places, path: Path, need: int, whole: int, said: str) -> Finding:
    """Whether `need` bytes fit at `path`; a store elsewhere would begin with the `whole`."""
    what = f"{megabytes(_free(path))} are free, {said}"
    if _free(path) >= need:
        return Finding(path, what)
    what += "; free some, or set INDUSTNERF_STORE to a larger disk"
    here = places.root / ".store"
    if path == places.store and _free(here) >= whole:
        return Finding(path, what, f"export INDUSTNERF_STORE={shlex.quote(str(here))}")
    if _existing(path).stat().st_dev != places.root.stat().st_dev:
        return Finding(path, what, wrong=True)
    alone = {project: size for project in places.projects() if (size := _alone(project))}
    if alone:
        what += f"; DVC's cache can give back {megabytes(sum(alone.values()))} at most"
    return Finding(path, what, _collect(places, alone), wrong=True)


def _alone(project: Project) -> int:
    """The most bytes that go if DVC drops what it does not need: what is linked elsewhere stays."""
    files = (path.stat() for path in objects(project) if path.suffix != ".dir")
    return sum(facts.st_size for facts in files if facts.st_nlink == 1)


def _collect(places: Places, projects: Iterable[Project]) -> str:
    """Without what no output of today needs; it asks nothing, and spares the store."""
    folders = (places.words(project.folder) for project in projects)
    return " && ".join(f"(cd {folder} && dvc gc --workspace --force)" for folder in folders)
