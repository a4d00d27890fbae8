"""Publish a sweep of single changes: its table in a document, its points beside it.

python -m pipeline.ablation_effects runs/sweeps/<of experiment=readings>  docs/reference/readings.md
python -m pipeline.ablation_effects runs/sweeps/<of experiment=ablation>  docs/reference/method.md
"""

import shutil
from dataclasses import asdict
from pathlib import Path

from industnerf.artifacts.files import write_text
from industnerf.cli import run_command
from industnerf.config import flatten, load_params
from industnerf.errors import BadArtifact
from industnerf.report.docs.markdown_blocks import replace_block
from industnerf.report.publish.provenance import read_provenance
from industnerf.report.sweeps.ablations import (
    ADDITION_METHODS,
    ablation_table,
    read_point_scores,
    readings_table,
)
from industnerf.report.sweeps.points import preset_of
from industnerf.schema.readings import READING_IDS

DOCUMENTS = {
    "readings": (Path("docs/reference/readings.md"), Path("docs/reference/readings.csv")),
    "ablation": (Path("docs/reference/method.md"), Path("docs/reference/ablation.csv")),
}


def main(folder: str) -> None:
    sweep = Path(folder)
    preset = preset_of(sweep)
    if preset not in DOCUMENTS:
        expected = " or ".join(f"experiment={name}" for name in DOCUMENTS)
        raise BadArtifact(f"{sweep} is of preset {preset!r}, not of {expected}")
    document, csv_path = DOCUMENTS[preset]
    provenance = read_provenance(sweep)
    text = f"{provenance['date']}, commit {provenance['commit']}.\n\n{effects_table(sweep, preset)}"
    write_text(document, replace_block(document.read_text(encoding="utf-8"), preset, text))
    shutil.copyfile(sweep / "sweep.csv", csv_path)


def effects_table(sweep: Path, preset: str) -> str:
    """The table of what the sweep found."""
    params = load_params()
    if preset == "ablation":
        default_settings = flatten(asdict(params.method.industnerf_plus), split_lists=True)
        return ablation_table(
            read_point_scores(sweep, ADDITION_METHODS),
            default_settings,
            params.report,
        )
    default = params.method.industnerf.readings
    return readings_table(read_point_scores(sweep), default, READING_IDS, params.report)


if __name__ == "__main__":
    run_command(main)
