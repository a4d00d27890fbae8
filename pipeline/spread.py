"""Bring the spread over seeds under version control, from the sweeps that measured it.

python -m pipeline.sweep experiment=seeds
python -m pipeline.sweep experiment=seeds_nets
python -m pipeline.spread runs/sweeps/seeds runs/sweeps/seeds_nets

python -m pipeline.spread     only writes the tables anew, with what the published study has in mm

Methods that no sweep named here measured stay as they are.
"""

import json
from pathlib import Path

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
MADE = OUT / "made.json"


def main(*sweeps: str) -> None:
    folders = [Path(sweep) for sweep in sweeps]
    # of each sweep, which is whole: another day and commit than today's may have made it
    made = {seeds_of(folder): read_made(folder) for folder in folders}
    rows = merged(spreads(folders), read_seeds(OUT))
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
        before = json.loads(MADE.read_text(encoding="utf-8"))["sweeps"] if MADE.exists() else {}
        write_json(MADE, {"schema": 1, "sweeps": before | made})
    print(seeds_md(rows), end="")


def merged(found: list[Spread], before: list[Spread]) -> list[Spread]:
    """What was `found`, and of other methods what was known `before`; the best first."""
    named = {row.method for row in found}
    rows = [*found, *(row for row in before if row.method not in named)]
    return sorted(rows, key=lambda row: row.mean)


def seeds_of(sweep: Path) -> str:
    """The preset of a sweep over seeds; raises BadArtifact if it is another, or unfinished."""
    preset = preset_of(sweep)
    if preset not in PRESETS:
        wanted = " or ".join(f"experiment={name}" for name in PRESETS)
        raise BadArtifact(f"{sweep} is of preset {preset!r}, not of {wanted}")
    return preset


if __name__ == "__main__":
    run_command(main)
