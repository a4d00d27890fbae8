"""Bring the demo's table and picture, as they are now, into the README: `make readme`."""

from pathlib import Path

from PIL import Image

from industnerf.cli import exit_with_message
from industnerf.errors import BadArtifact
from industnerf.report.blocks import replace_block

WIDTH = 2200  # px of the picture
README, DEMO = Path("README.md"), Path("runs/demo/reports")


def main() -> None:
    if not (DEMO / "table1.md").exists():
        raise BadArtifact(f"{DEMO}/table1.md is missing; `make demo` writes it")
    table = (DEMO / "table1.md").read_text()
    README.write_text(replace_block(README.read_text(), "demo", table))
    with Image.open(DEMO / "contact_sheet.png") as sheet:
        sheet.thumbnail((WIDTH, WIDTH))
        sheet.save("docs/demo.png", optimize=True)


if __name__ == "__main__":
    exit_with_message(main)
