"""dvc.lock: what DVC believes to have run.  It is rewritten in place: a kill can cut it short.

Where git has a whole one, that is put back.  Else the file goes, and `dvc repro` takes finished
stages from its run cache and the store.
"""

import subprocess
from pathlib import Path
from typing import Any

import yaml

from industnerf.doctor.findings import Finding
from industnerf.doctor.places import Places, Project
from industnerf.errors import BadArtifact

# The C reader takes a fifth of the time; only the shape counts here, so any reader will do.
LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


def find(places: Places) -> list[Finding]:
    """At most one finding a project.  Without dvc.lock nothing has run, and nothing is wrong."""
    locked = [project for project in places.projects() if (project.folder / "dvc.lock").exists()]
    return [finding for project in locked for finding in _findings(places, project)]


def require_whole(places: Places, folder: Path) -> None:
    """Raises BadArtifact, with what mends it, if DVC would stop at the dvc.lock of `folder`."""
    lock = folder / "dvc.lock"
    if not lock.exists() or not torn(lock.read_text(errors="replace")):
        return
    for project in places.projects():
        for finding in _findings(places, project) if project.folder == folder else []:
            where = places.words(finding.where)
            raise BadArtifact(f"{where}: {finding.what}.\nThis mends it: {finding.mend}")


def _findings(places: Places, project: Project) -> list[Finding]:
    path, known = project.folder / "dvc.lock", _stages(project.folder / "dvc.yaml")
    what = fault(path.read_text(errors="replace"), known)
    if not what:
        return []
    committed = _committed(path)
    if committed and not fault(committed, known):
        mend = f"git checkout HEAD -- {places.words(path)}"
    else:
        mend = f"rm {places.words(path)} && {project.rerun}"
    return [Finding(path, f"{what}; DVC stops at it, or trusts it wrongly", mend)]


def fault(text: str, known: set[str]) -> str:
    """What is wrong with `text` as a dvc.lock of the stages `known`, or an empty text."""
    return torn(text) or _foreign(yaml.load(text, LOADER)["stages"], known)


def torn(text: str) -> str:
    """What keeps `text` from being a whole dvc.lock, or an empty text."""
    try:
        content = yaml.load(text, LOADER)
    except yaml.YAMLError as error:
        return f"no YAML: {' '.join(str(error).split())[:160]}"
    if not isinstance(content, dict) or not {"schema", "stages"} <= set(content):
        return f"has {len(text)} characters and lacks schema or stages: cut short"
    return _cut_short(content["stages"])


def _cut_short(stages: Any) -> str:
    if not isinstance(stages, dict):
        return "its stages are empty: cut short"
    bare = [n for n, stage in stages.items() if not isinstance(stage, dict) or "cmd" not in stage]
    return f"stage {bare[0]} has no cmd: cut short" if bare else ""


def _foreign(stages: dict[str, Any], known: set[str]) -> str:
    foreign = sorted({name.partition("@")[0] for name in stages} - known)
    return f"has stages that dvc.yaml has not: {', '.join(foreign)}" if foreign else ""


def _stages(pipeline: Path) -> set[str]:
    try:
        return set(yaml.load(pipeline.read_text(encoding="utf-8"), LOADER)["stages"])
    except (yaml.YAMLError, KeyError, TypeError) as error:
        raise BadArtifact(f"{pipeline} is not to be read: {' '.join(str(error).split())}") from None


def _committed(path: Path) -> str:
    """The file as git has it, or an empty text."""
    try:
        done = subprocess.run(
            ["git", "show", f"HEAD:./{path.name}"],
            cwd=path.parent,
            check=False,
            capture_output=True,
            text=True,
        )
    except OSError:
        return ""
    return done.stdout if done.returncode == 0 else ""
