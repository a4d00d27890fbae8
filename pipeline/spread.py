"""Bring the spread over seeds under version control, from the sweeps that measured it.

python -m pipeline.sweep experiment=seeds
python -m pipeline.sweep experiment=seeds_nets
python -m pipeline.spread runs/sweeps/seeds runs/sweeps/seeds_nets
"""

import sys
from pathlib import Path

from industnerf.artifacts.files import write_json, write_text
from industnerf.cli import exit_with_message
from industnerf.errors import BadArtifact
from industnerf.report.provenance import environment, made_by
from industnerf.report.spread import seeds_csv, seeds_md, spreads

OUT = Path("results/seeds")


def main(*sweeps: str) -> None:
    if not sweeps:
        raise BadArtifact("name the folders of the sweeps, such as runs/sweeps/seeds")
    rows = spreads([Path(sweep) for sweep in sweeps])
    made = made_by(f"python -m pipeline.spread {' '.join(sweeps)}")
    write_text(OUT / "seeds.csv", seeds_csv(rows))
    write_text(OUT / "seeds.md", seeds_md(rows))
    write_json(OUT / "environment.json", environment())
    write_json(OUT / "made.json", made)
    print(seeds_md(rows), end="")


if __name__ == "__main__":
    exit_with_message(lambda: main(*sys.argv[1:]))
