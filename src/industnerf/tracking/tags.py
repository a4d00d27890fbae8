"""What a report's run is tagged with, noted beside the report for whenever it is logged."""

import json
from pathlib import Path

from industnerf import git
from industnerf.artifacts.files import write_json
from industnerf.errors import BadArtifact

FILE = "label.json"


def save_tags(report: Path, **tags: str) -> None:
    """Note how the run of the report in `report` is to be tagged, today's commit included.

    Of a sweep the tag `point` says what was set.
    """
    write_json(report / FILE, {**git_state(), **tags})


def load_tags(report: Path) -> dict[str, str]:
    """What `save_tags` noted; of published results their commit; empty where nothing is known."""
    if (report / FILE).exists():
        noted = json.loads((report / FILE).read_text(encoding="utf-8"))
        return {key.removeprefix("git."): value for key, value in noted.items()}  # of older reports
    if (report / "made.json").exists():
        made = json.loads((report / "made.json").read_text(encoding="utf-8"))
        return {"commit": made["commit"], "dirty": str(not made["clean"]).lower()}
    return {}


def git_state() -> dict[str, str]:
    """Commit, and whether the tree differs from it; empty outside a repository."""
    try:
        return {"commit": git.head_commit(), "dirty": str(bool(git.changed_paths())).lower()}
    except BadArtifact:
        return {}
