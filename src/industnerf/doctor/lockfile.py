"""dvc.lock: what DVC believes to have run.  It is rewritten in place: a kill can cut it short."""

from pathlib import Path
from typing import Any

import yaml

from industnerf.doctor.findings import Finding
from industnerf.doctor.places import Places, Project

# The C reader takes a fifth of the time; only the shape counts here, so any reader will do.
LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


def find(places: Places) -> list[Finding]:
    """At most one finding a project.  Without dvc.lock nothing has run, and nothing is wrong."""
    return [
        Finding(
            path,
            f"{what}; `dvc repro` stops at it or trusts it wrongly, and without the file takes "
            "finished stages from its run cache",
            f"rm {places.words(path)} && {project.rerun}",
        )
        for project in places.projects()
        if (path := project.folder / "dvc.lock").exists() and (what := _fault(project, path))
    ]


def _fault(project: Project, path: Path) -> str:
    """What is wrong with the dvc.lock in `path`, or an empty text."""
    text = path.read_text(errors="replace")
    try:
        content = yaml.load(text, LOADER)
    except yaml.YAMLError as error:
        return f"no YAML: {' '.join(str(error).split())[:160]}"
    wanted = {"schema", "stages"}
    if not isinstance(content, dict) or not wanted <= set(content):
        return f"has {len(text)} bytes and lacks schema or stages: cut short"
    return _stages_fault(content["stages"], _known(project.folder / "dvc.yaml"))


def _stages_fault(stages: Any, known: set[str]) -> str:
    if not isinstance(stages, dict):
        return "its stages are empty: cut short"
    torn = [n for n, stage in stages.items() if not isinstance(stage, dict) or "cmd" not in stage]
    if torn:
        return f"stage {torn[0]} has no cmd: cut short"
    foreign = sorted({name.partition("@")[0] for name in stages} - known)
    return f"has stages that dvc.yaml has not: {', '.join(foreign)}" if foreign else ""


def _known(pipeline: Path) -> set[str]:
    return set(yaml.load(pipeline.read_text(), LOADER)["stages"])
