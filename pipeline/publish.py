"""Bring the finished study's numbers under version control: `make results`.

results/study    tables, scores, costs, small pictures, machine and commit
README.md        what stands between its marks `study`

python -m pipeline.publish readme    README.md alone: after params.yaml has changed, it says so
"""

import json
import subprocess
import sys
from pathlib import Path

from industnerf.artifacts.files import write_text
from industnerf.cli import exit_with_message
from industnerf.config import PARAMS, load_params
from industnerf.errors import BadArtifact
from industnerf.report.provenance import made_by
from industnerf.report.publish import publish
from industnerf.report.readme import replace_block, study_block

REPORT, OUT, README = Path("reports"), Path("results/study"), Path("README.md")


def main() -> None:
    if sys.argv[1:] != ["readme"]:
        check_finished()
        params = load_params()
        facts = {"preset": params.preset, "interval": params.report.interval}
        publish(REPORT, OUT, made_by("make repro") | facts, Path())
    shown = study_block(OUT, PARAMS)
    write_text(README, replace_block(README.read_text(), "study", shown))
    print(f"{OUT} and {README}; commit them together with dvc.lock")


def check_finished() -> None:
    """Raises BadArtifact if a stage is not up to date: its numbers are not those of this tree."""
    status = subprocess.run(["dvc", "status", "--json"], capture_output=True, text=True)
    if status.returncode:
        raise BadArtifact(f"`dvc status` failed: {status.stderr.strip()}")
    outdated = list(json.loads(status.stdout))
    if outdated:
        raise BadArtifact(
            f"the study is not finished: {len(outdated)} stages are not up to date, the first is "
            f"{outdated[0]}; `make repro` goes on"
        )


if __name__ == "__main__":
    exit_with_message(main)
