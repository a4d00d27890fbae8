"""Bring a finished sweep into docs/sweeps/, and its row into the table of docs/sweeps.md.

python -m pipeline.sweeps runs/sweeps/2026-01-31_12-00-00 "2 cores, no GPU, nothing else running"
python -m pipeline.sweeps        only writes the table anew
python -m pipeline.sweeps redraw sweep-nets    draws a published plot anew, from its sweep.csv
"""

import shutil
from pathlib import Path

from PIL import Image

from industnerf.artifacts.files import write_json, write_text
from industnerf.cli import run_command
from industnerf.errors import BadArtifact
from industnerf.report.blocks import replace_block
from industnerf.report.provenance import read_made
from industnerf.report.sweep_index import (
    BROUGHT_BY,
    PUBLISHED,
    TABLES,
    brought_by,
    index,
    presets,
)
from industnerf.report.sweep_plot import plot
from industnerf.report.sweep_points import SELECT, core_seconds, preset_of
from industnerf.report.sweep_reread import reread_sweep
from industnerf.report.sweep_series import series, trends

DOCUMENT, COLOURS = Path("docs/sweeps.md"), 64


def main(sweep: str = "", machine: str = "") -> None:
    if sweep == "redraw":
        redraw(PUBLISHED / machine)
    elif sweep:
        publish(Path(sweep), machine)
    write_text(
        DOCUMENT, replace_block(DOCUMENT.read_text(encoding="utf-8"), "sweeps", index(Path.cwd()))
    )


def publish(sweep: Path, machine: str) -> None:
    """Copy tables and plot; raises BadArtifact if the sweep is not finished or of no preset."""
    name = preset_of(sweep)
    if name not in [preset.name for preset in presets(Path.cwd())]:
        publishes = f"; `python -m {brought_by(name)}` publishes it" if name in BROUGHT_BY else ""
        raise BadArtifact(f"{sweep} is of preset {name!r}, which has no row here{publishes}")
    needed = [*(file for _, file in TABLES), "sweep.png"]
    if missing := [file for file in needed if not (sweep / file).exists()]:
        raise BadArtifact(f"{sweep} lacks {', '.join(missing)}; the same sweep writes them")
    folder = PUBLISHED / name
    folder.mkdir(parents=True, exist_ok=True)
    for _, table in TABLES:
        shutil.copy(sweep / table, folder / table)
    _shrink(sweep / "sweep.png", folder / "sweep.png")
    about = {
        **read_made(sweep),
        "machine": machine or "unknown",
        "core_minutes": round(core_seconds(sweep) / 60, 1),
    }
    write_json(folder / "about.json", about)


def redraw(folder: Path) -> None:
    """The plot published in `folder`; not one over parts, whose faces are not kept."""
    if not (folder / "sweep.csv").exists():
        raise BadArtifact(f"{folder} has no sweep.csv: name a sweep that is published")
    points, swept = reread_sweep(folder)
    if swept[0] == SELECT:
        raise BadArtifact(f"{folder / 'sweep.csv'} does not say how many faces the parts have")
    lines = series(points, swept)
    plot(lines, trends(lines, swept[0]), swept[0], folder / "sweep.png")
    _shrink(folder / "sweep.png", folder / "sweep.png")


def _shrink(source: Path, target: Path) -> None:
    with Image.open(source) as picture:
        picture.convert("RGB").quantize(COLOURS).save(target, optimize=True)


if __name__ == "__main__":
    run_command(main)
