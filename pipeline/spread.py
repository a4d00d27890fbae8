"""Bring the spread over seeds under version control, from the sweeps that measured it.

python -m pipeline.sweep experiment=seeds
python -m pipeline.sweep experiment=seeds_nets
python -m pipeline.spread runs/sweeps/seeds runs/sweeps/seeds_nets
"""

from pathlib import Path

from industnerf.artifacts.files import read_json, write_json, write_text
from industnerf.cli import run_command
from industnerf.errors import BadArtifact
from industnerf.report.spread import seeds_csv, seeds_md, spreads
from industnerf.report.sweep_points import preset_of

OUT = Path("results/seeds")


def main(*sweeps: str) -> None:
    if not sweeps:
        raise BadArtifact("name the folders of the sweeps, such as runs/sweeps/seeds")
    folders = [Path(sweep) for sweep in sweeps]
    # of each sweep, which is whole: another day and commit than today's may have made it
    made = {preset_of(folder): read_json(folder / "made.json", 1, "sweep") for folder in folders}
    rows = spreads(folders)
    write_text(OUT / "seeds.csv", seeds_csv(rows))
    write_text(OUT / "seeds.md", seeds_md(rows))
    write_json(OUT / "made.json", {"schema": 1, "sweeps": made})
    print(seeds_md(rows), end="")


if __name__ == "__main__":
    run_command(main)
