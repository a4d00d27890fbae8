"""Bring a finished sweep into docs/sweeps/, and its row into the table of docs/sweeps.md.

python -m pipeline.sweeps runs/sweeps/2026-01-31_12-00-00 "2 cores, no GPU, nothing else running"
python -m pipeline.sweeps        only writes the table anew
"""

import json
import shutil
from pathlib import Path

from PIL import Image

from industnerf.artifacts.files import write_json, write_text
from industnerf.cli import run_command
from industnerf.errors import BadArtifact
from industnerf.report.blocks import replace_block
from industnerf.report.sweep_index import PUBLISHED, index, presets
from industnerf.report.sweep_points import core_seconds, preset_of

TABLES = ("sweep.csv", "steps.csv", "trend.csv")
DOCUMENT, COLOURS = Path("docs/sweeps.md"), 64


def main(sweep: str = "", machine: str = "") -> None:
    if sweep:
        publish(Path(sweep), machine)
    write_text(DOCUMENT, replace_block(DOCUMENT.read_text(), "sweeps", index(Path.cwd())))


def publish(sweep: Path, machine: str) -> None:
    """Copy tables and plot; raises BadArtifact if the sweep is not finished or of no preset."""
    name = preset_of(sweep)
    if name not in [preset.name for preset in presets(Path.cwd())]:
        raise BadArtifact(f"{sweep} is of preset {name!r}, not of a sweep of conf/experiment/")
    needed = [*TABLES, "sweep.png"]
    if missing := [file for file in needed if not (sweep / file).exists()]:
        raise BadArtifact(f"{sweep} lacks {', '.join(missing)}; the same sweep writes them")
    folder = PUBLISHED / name
    folder.mkdir(parents=True, exist_ok=True)
    for table in TABLES:
        shutil.copy(sweep / table, folder / table)
    with Image.open(sweep / "sweep.png") as plot:
        plot.convert("RGB").quantize(COLOURS).save(folder / "sweep.png", optimize=True)
    about = {
        **json.loads((sweep / "made.json").read_text()),
        "machine": machine or "unknown",
        "core_minutes": round(core_seconds(sweep) / 60, 1),
    }
    write_json(folder / "about.json", about)


if __name__ == "__main__":
    run_command(main)
