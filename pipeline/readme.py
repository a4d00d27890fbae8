"""Bring the demo's table and picture, as they are now, into the README: `make readme`."""

import re
from pathlib import Path

from PIL import Image

from industnerf.cli import exit_with_message
from industnerf.errors import BadArtifact

WIDTH = 2200  # px of the picture
README, DEMO = Path("README.md"), Path("runs/demo/reports")


def main() -> None:
    if not (DEMO / "table1.md").exists():
        raise BadArtifact(f"{DEMO}/table1.md is missing; `make demo` writes it")
    table = (DEMO / "table1.md").read_text()
    block = f"<!-- demo -->\n{table}<!-- end demo -->"
    README.write_text(
        re.sub(r"<!-- demo -->.*<!-- end demo -->", block, README.read_text(), flags=re.S)
    )
    with Image.open(DEMO / "contact_sheet.png") as sheet:
        sheet.thumbnail((WIDTH, WIDTH))
        sheet.save("docs/demo.png", optimize=True)


if __name__ == "__main__":
    exit_with_message(main)
