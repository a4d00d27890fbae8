"""Bring a finished sweep into docs/reference/sweeps/, and its row into sweeps.md beside it.

python -m pipeline.sweep_docs runs/sweeps/2026-01-31_12-00-00 "2 cores, no GPU, idle"
python -m pipeline.sweep_docs        only writes the table anew
python -m pipeline.sweep_docs redraw sweep-nets    draws a published plot anew, from its sweep.csv
"""

import shutil
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from PIL import Image

from industnerf.artifacts.files import write_json, write_text
from industnerf.cli import run_command
from industnerf.errors import BadArtifact
from industnerf.report.docs.markdown_blocks import replace_block
from industnerf.report.publish.provenance import read_provenance
from industnerf.report.sweeps.plot import plot_sweep
from industnerf.report.sweeps.points import (
    SELECT_KEY,
    core_seconds,
    preset_of,
    read_published_sweep,
)
from industnerf.report.sweeps.preset_table import (
    PUBLISHED,
    PUBLISHED_BY,
    TABLES,
    published_exponents,
    publishing_module,
    sweep_presets,
    sweep_table,
)
from industnerf.report.sweeps.series import Trend, fit_trends, make_series

DOCUMENT, PALETTE_SIZE = Path("docs/reference/sweeps.md"), 64


def main(sweep: str = "", machine: str = "") -> None:
    if sweep == "redraw":
        redraw_plot(PUBLISHED / machine)
    elif sweep:
        publish_sweep(Path(sweep), machine)
    write_text(
        DOCUMENT,
        replace_block(DOCUMENT.read_text(encoding="utf-8"), "sweeps", sweep_table(Path.cwd())),
    )


def publish_sweep(sweep: Path, machine: str) -> None:
    """Copy tables and plot; raises BadArtifact if the sweep is not finished or of no preset."""
    name = preset_of(sweep)
    if name not in [preset.name for preset in sweep_presets(Path.cwd())]:
        hint = (
            f"; `python -m {publishing_module(name)}` publishes it" if name in PUBLISHED_BY else ""
        )
        raise BadArtifact(f"{sweep} is of preset {name!r}, which has no row here{hint}")
    expected_files = [*(file for _, file in TABLES), "sweep.png"]
    if missing := [file for file in expected_files if not (sweep / file).exists()]:
        raise BadArtifact(f"{sweep} lacks {', '.join(missing)}; the same sweep writes them")
    folder = PUBLISHED / name
    folder.mkdir(parents=True, exist_ok=True)
    for _, table in TABLES:
        shutil.copy(sweep / table, folder / table)
    _quantize_png(sweep / "sweep.png", folder / "sweep.png")
    metadata = {
        **read_provenance(sweep),
        "machine": machine or "unknown",
        "core_minutes": round(core_seconds(sweep) / 60, 1),
    }
    write_json(folder / "about.json", metadata)


def redraw_plot(folder: Path) -> None:
    """The plot published in `folder`; not one over parts, whose faces are not kept."""
    if not (folder / "sweep.csv").exists():
        raise BadArtifact(f"{folder} has no sweep.csv: name a sweep that is published")
    points, swept_keys = read_published_sweep(folder)
    if swept_keys[0] == SELECT_KEY:
        raise BadArtifact(f"{folder / 'sweep.csv'} does not say how many faces the parts have")
    curves = make_series(points, swept_keys)
    trends = published_trends(folder, fit_trends(curves, swept_keys[0]))
    plot_sweep(curves, trends, swept_keys[0], folder / "sweep.png")
    _quantize_png(folder / "sweep.png", folder / "sweep.png")


def published_trends(folder: Path, fitted: Sequence[Trend]) -> list[Trend]:
    """`fitted` to the rounded costs of sweep.csv, with the exponents that the table shows."""
    exponents = published_exponents(folder)
    trends = []
    for trend in fitted:
        if (trend.label, trend.quantity) in exponents:
            exponent, error = exponents[trend.label, trend.quantity]
            trends.append(replace(trend, law=replace(trend.law, exponent=exponent, error=error)))
    return trends


def _quantize_png(source: Path, target: Path) -> None:
    with Image.open(source) as image:
        image.convert("RGB").quantize(PALETTE_SIZE).save(target, optimize=True)


if __name__ == "__main__":
    run_command(main)
