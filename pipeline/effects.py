"""Bring a sweep of one change at a time into the document that asks about it, its points beside it.

python -m pipeline.effects runs/sweeps/<of experiment=readings>    docs/readings.md
python -m pipeline.effects runs/sweeps/<of experiment=ablation>    docs/method.md
"""

import shutil
from dataclasses import asdict
from pathlib import Path

from industnerf.artifacts.files import write_text
from industnerf.cli import run_command
from industnerf.config import load_params
from industnerf.errors import BadArtifact
from industnerf.report import ablation, effects
from industnerf.report.blocks import replace_block
from industnerf.report.leaves import leaves
from industnerf.report.provenance import read_made
from industnerf.report.sweep_points import preset_of
from industnerf.schema.readings import NUMBERS

DOCUMENTS = {
    "readings": (Path("docs/readings.md"), Path("docs/readings.csv")),
    "ablation": (Path("docs/method.md"), Path("docs/ablation.csv")),
}


def main(folder: str) -> None:
    sweep = Path(folder)
    preset = preset_of(sweep)
    if preset not in DOCUMENTS:
        wanted = " or ".join(f"experiment={name}" for name in DOCUMENTS)
        raise BadArtifact(f"{sweep} is of preset {preset!r}, not of {wanted}")
    document, points = DOCUMENTS[preset]
    made = read_made(sweep)
    text = f"{made['date']}, commit {made['commit']}.\n\n{found_by(sweep, preset)}"
    write_text(document, replace_block(document.read_text(encoding="utf-8"), preset, text))
    shutil.copyfile(sweep / "sweep.csv", points)


def found_by(sweep: Path, preset: str) -> str:
    """The table of what the sweep found."""
    params = load_params()
    if preset == "ablation":
        usual = leaves(asdict(params.method.industnerf_plus))
        return ablation.table(effects.outcomes(sweep, ablation.METHODS), usual, params.report)
    default = params.method.industnerf.readings
    return effects.table(effects.outcomes(sweep), default, NUMBERS, params.report)


if __name__ == "__main__":
    run_command(main)
