"""Bring the spread over seeds under version control, from the sweeps that measured it.

python -m pipeline.sweep experiment=seeds
python -m pipeline.sweep experiment=seeds_nets
python -m pipeline.seed_variance runs/sweeps/seeds runs/sweeps/seeds_nets

python -m pipeline.seed_variance     only writes the tables anew, with what the published study has in mm

Methods that no sweep named here measured stay as they are.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from industnerf.artifacts.files import write_json, write_text
from industnerf.cli import run_command
from industnerf.errors import BadArtifact
from industnerf.parts.catalogue.entries import read_catalogue, to_part
from industnerf.report.publish.provenance import read_provenance
from industnerf.report.statistics.seed_variance import (
    SeedVariance,
    add_mean_mm,
    emds_with_seed_0,
    read_seed_variances,
    seed_variances,
    seeds_csv,
    seeds_md,
)
from industnerf.report.sweeps.points import preset_of

PRESETS = ("seeds", "seeds_nets")
OUT, STUDY = Path("results/seeds"), Path("results/study")


def main(*sweeps: str) -> None:
    folders = [Path(sweep) for sweep in sweeps]
    # of each sweep, which is whole: another day and commit than today's may have made it
    provenance = {seed_preset_of(folder): _sweep_provenance(folder) for folder in folders}
    published_sweeps = read_provenance(OUT)["sweeps"] if (OUT / "made.json").exists() else {}
    kept_sweeps = {
        name: sweep for name, sweep in published_sweeps.items() if name not in provenance
    }
    rows = merge_rows(seed_variances(folders), read_seed_variances(OUT), kept_sweeps)
    if not rows:
        raise BadArtifact(f"{OUT} holds no seeds.csv: name the sweeps that measured the spread")
    reports = [path for folder in folders for path in folder.glob("*/reports")]
    if not folders and (STUDY / "scores.csv").exists():
        reports = [STUDY]
    rows = add_mean_mm(
        rows,
        emds_with_seed_0(reports),
        {part.part_id: part.diagonal_mm for part in map(to_part, read_catalogue())},
    )
    write_text(OUT / "seeds.csv", seeds_csv(rows))
    write_text(OUT / "seeds.md", seeds_md(rows))
    if folders:
        write_json(OUT / "made.json", {"schema": 1, "sweeps": kept_sweeps | provenance})
    print(seeds_md(rows), end="")


def _sweep_provenance(sweep: Path) -> dict[str, Any]:
    """Where the sweep was made, and of which methods it is."""
    return read_provenance(sweep) | {
        "methods": sorted(row.method for row in seed_variances([sweep]))
    }


def merge_rows(
    new_rows: list[SeedVariance],
    published_rows: list[SeedVariance],
    kept_sweeps: Mapping[str, dict[str, Any]],
) -> list[SeedVariance]:
    """What was `found`, and what was known `before` of methods of the sweeps `kept`, best first."""
    kept_methods = {method for sweep in kept_sweeps.values() for method in sweep["methods"]}
    kept_methods -= {row.method for row in new_rows}
    return sorted(
        [*new_rows, *(row for row in published_rows if row.method in kept_methods)],
        key=lambda r: r.mean,
    )


def seed_preset_of(sweep: Path) -> str:
    """The preset of a sweep over seeds; raises BadArtifact if it is another, or unfinished."""
    preset = preset_of(sweep)
    if preset not in PRESETS:
        expected = " or ".join(f"experiment={name}" for name in PRESETS)
        raise BadArtifact(f"{sweep} is of preset {preset!r}, not of {expected}")
    return preset


if __name__ == "__main__":
    run_command(main)
