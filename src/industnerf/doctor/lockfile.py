"""dvc.lock: what DVC believes to have run.  It is rewritten in place: a kill can cut it short.

Where git has a whole one, that is put back.  Else the file goes, and `dvc repro` takes finished
stages from its run cache and the store.
"""

import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import yaml

from industnerf.doctor.findings import Finding
from industnerf.doctor.project_paths import Project, ProjectPaths
from industnerf.errors import BadArtifact

# The C reader takes a fifth of the time; only the shape counts here, so any reader will do.
LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


def check(paths: ProjectPaths) -> list[Finding]:
    """At most one finding a project.  Without dvc.lock nothing has run, and nothing is wrong."""
    projects = [project for project in paths.projects() if (project.folder / "dvc.lock").exists()]
    return [finding for project in projects for finding in _findings(paths, project)]


def replace_torn(folder: Path) -> None:
    """Set a torn dvc.lock of `folder` aside, put back what git has of it, and say so.

    Nothing is lost: of stages that are not in it DVC asks its run cache, and they the store.
    """
    lock = folder / "dvc.lock"
    problem = find_truncation(lock.read_text(errors="replace")) if lock.exists() else ""
    if not problem:
        return
    aside = folder / ".dvc" / "tmp" / f"dvc.lock.torn-{time.time_ns()}"
    aside.parent.mkdir(parents=True, exist_ok=True)
    lock.rename(aside)
    committed = _committed_text(lock)
    if committed and not find_truncation(committed):
        lock.write_text(committed, encoding="utf-8")
        origin = "the last committed one is put back"
    else:
        origin = "DVC starts a new one"
    print(
        f"{lock}: {problem}. It is set aside, {aside}, and {origin}: finished parts are kept.",
        file=sys.stderr,
    )


def _findings(paths: ProjectPaths, project: Project) -> list[Finding]:
    path, known_stages = project.folder / "dvc.lock", _stage_names(project.folder / "dvc.yaml")
    problem = find_problem(path.read_text(errors="replace"), known_stages)
    if not problem:
        return []
    committed = _committed_text(path)
    if committed and not find_problem(committed, known_stages):
        fix = f"git checkout HEAD -- {paths.shell_words(path)}"
    else:
        fix = f"rm {paths.shell_words(path)} && {project.rerun_command}"
    return [Finding(path, f"{problem}; DVC stops at it, or trusts it wrongly", fix)]


def find_problem(text: str, known: set[str]) -> str:
    """What is wrong with `text` as a dvc.lock of the stages `known`, or an empty text."""
    return find_truncation(text) or _find_unknown_stages(yaml.load(text, LOADER)["stages"], known)


def find_truncation(text: str) -> str:
    """What keeps `text` from being a whole dvc.lock, or an empty text."""
    try:
        content = yaml.load(text, LOADER)
    except yaml.YAMLError as error:
        return f"no YAML: {' '.join(str(error).split())[:160]}"
    if not isinstance(content, dict) or not {"schema", "stages"} <= set(content):
        return f"has {len(text)} characters and lacks schema or stages: cut short"
    return _find_incomplete_stage(content["stages"]) or _find_schema_error(content)


def _find_schema_error(content: dict[str, Any]) -> str:
    """What DVC refuses of a lock that ends within an entry, and is YAML all the same."""
    from dvc.schema import COMPILED_LOCKFILE_SCHEMA  # late: slow to import
    from voluptuous import Invalid

    try:
        COMPILED_LOCKFILE_SCHEMA(content)
    except Invalid as error:
        return f"no lock file of DVC: {error}: cut short"
    return ""


def _find_incomplete_stage(stages: Any) -> str:
    if not isinstance(stages, dict):
        return "its stages are empty: cut short"
    incomplete = [
        n for n, stage in stages.items() if not isinstance(stage, dict) or "cmd" not in stage
    ]
    return f"stage {incomplete[0]} has no cmd: cut short" if incomplete else ""


def _find_unknown_stages(stages: dict[str, Any], known: set[str]) -> str:
    unknown = sorted({name.partition("@")[0] for name in stages} - known)
    return f"has stages that dvc.yaml has not: {', '.join(unknown)}" if unknown else ""


def _stage_names(pipeline: Path) -> set[str]:
    try:
        return set(yaml.load(pipeline.read_text(encoding="utf-8"), LOADER)["stages"])
    except (yaml.YAMLError, KeyError, TypeError) as error:
        raise BadArtifact(f"{pipeline} is not to be read: {' '.join(str(error).split())}") from None


def _committed_text(path: Path) -> str:
    """The file as git has it, or an empty text."""
    try:
        process = subprocess.run(
            ["git", "show", f"HEAD:./{path.name}"],
            cwd=path.parent,
            check=False,
            capture_output=True,
            text=True,
        )
    except OSError:
        return ""
    return process.stdout if process.returncode == 0 else ""
