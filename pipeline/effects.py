"""Bring what a sweep says of the readings into docs/readings.md, its points to docs/readings.csv.

python -m pipeline.effects runs/sweeps/<of experiment=readings>
"""

import inspect
import json
import re
import shutil
import sys
from pathlib import Path

from industnerf.artifacts.files import write_text
from industnerf.cli import exit_with_message
from industnerf.config import load_params, read_yaml
from industnerf.errors import BadArtifact, BadParams
from industnerf.report.blocks import replace_block
from industnerf.report.effects import outcomes, table
from industnerf.schema import readings

DOCUMENT, POINTS = Path("docs/readings.md"), Path("docs/readings.csv")


def main() -> None:
    if len(sys.argv) != 2:
        raise BadParams("usage: python -m pipeline.effects runs/sweeps/<of experiment=readings>")
    params = load_params()
    default = params.method.industnerf.readings
    sweep = Path(sys.argv[1])
    for name, when in (("made.json", "start"), ("sweep.csv", "end")):
        if not (sweep / name).exists():
            raise BadArtifact(f"{sweep / name} is missing; a sweep writes it at its {when}")
    preset = read_yaml(next(sweep.glob("*/params.yaml")))["preset"]
    if preset != "readings":
        raise BadArtifact(f"{sweep} is of preset {preset!r}, not of experiment=readings")
    found = table(outcomes(sweep), default, numbers(), params.report)
    made = json.loads((sweep / "made.json").read_text())
    text = f"{made['date']}, commit {made['commit']}.\n\n{found}"
    write_text(DOCUMENT, replace_block(DOCUMENT.read_text(), "effects", text))
    shutil.copyfile(sweep / "sweep.csv", POINTS)


def numbers() -> dict[str, str]:
    """The number of every reading: pose -> R1."""
    source = inspect.getsource(readings.Readings)
    return dict(re.findall(r"^    (\w+): \w+  # (R\d+)$", source, re.MULTILINE))


if __name__ == "__main__":
    exit_with_message(main)
