"""Bring the spread over seeds under version control, from the sweeps that measured it.

python -m pipeline.sweep experiment=seeds
python -m pipeline.sweep experiment=seeds_nets
python -m pipeline.spread runs/sweeps/seeds runs/sweeps/seeds_nets

python -m pipeline.spread     only writes the tables anew, with what the published study has in mm

Methods that no sweep named here measured stay as they are.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from industnerf.artifacts.files import write_json, write_text
from industnerf.cli import run_command
from industnerf.errors import BadArtifact
from industnerf.parts.catalogue import catalogue
from industnerf.parts.embedded import as_part
from industnerf.report.provenance import read_made
from industnerf.report.spread import Spread, seed_0, spreads, with_mm
from industnerf.report.spread_files import read_seeds, seeds_csv, seeds_md
from industnerf.report.sweep_points import preset_of

PRESETS = ("seeds", "seeds_nets")
OUT, STUDY = Path("results/seeds"), Path("results/study")


def main(*sweeps: str) -> None:
    folders = [Path(sweep) for sweep in sweeps]
    # of each sweep, which is whole: another day and commit than today's may have made it
    made = {seeds_of(folder): _measured(folder) for folder in folders}
    before = read_made(OUT)["sweeps"] if (OUT / "made.json").exists() else {}
    kept = {name: sweep for name, sweep in before.items() if name not in made}
    rows = merged(spreads(folders), read_seeds(OUT), kept)
    if not rows:
        raise BadArtifact(f"{OUT} holds no seeds.csv: name the sweeps that measured the spread")
    reports = [path for folder in folders for path in folder.glob("*/reports")]
    if not folders and (STUDY / "scores.csv").exists():
        reports = [STUDY]
    rows = with_mm(
        rows, seed_0(reports), {p.part_id: p.diagonal_mm for p in map(as_part, catalogue())}
    )
    write_text(OUT / "seeds.csv", seeds_csv(rows))
    write_text(OUT / "seeds.md", seeds_md(rows))
    if folders:
        write_json(OUT / "made.json", {"schema": 1, "sweeps": kept | made})
    print(seeds_md(rows), end="")


def _measured(sweep: Path) -> dict[str, Any]:
    """Where the sweep was made, and of which methods it is."""
    return read_made(sweep) | {"methods": sorted(row.method for row in spreads([sweep]))}


def merged(
    found: list[Spread], before: list[Spread], kept: Mapping[str, dict[str, Any]]
) -> list[Spread]:
    """What was `found`, and what was known `before` of methods of the sweeps `kept`, best first."""
    others = {method for sweep in kept.values() for method in sweep["methods"]}
    others -= {row.method for row in found}
    return sorted([*found, *(row for row in before if row.method in others)], key=lambda r: r.mean)


def seeds_of(sweep: Path) -> str:
    """The preset of a sweep over seeds; raises BadArtifact if it is another, or unfinished."""
    preset = preset_of(sweep)
    if preset not in PRESETS:
        wanted = " or ".join(f"experiment={name}" for name in PRESETS)
        raise BadArtifact(f"{sweep} is of preset {preset!r}, not of {wanted}")
    return preset


if __name__ == "__main__":
    run_command(main)
