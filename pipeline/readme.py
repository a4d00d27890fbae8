"""Publish the demo in results/demo, and bring its table and picture into the README: `make readme`.

The README has columns of its Table 1, which the test suite makes anew of its scores.
"""

from pathlib import Path

from PIL import Image

from industnerf.artifacts.files import write_text
from industnerf.cli import exit_with_message
from industnerf.report.blocks import replace_block
from industnerf.report.readme import demo_block
from pipeline.publish import bring

WIDTH = 2200  # px of the picture
README, RUN, PUBLISHED = Path("README.md"), Path("runs/demo"), Path("results/demo")


def main() -> None:
    bring(RUN, PUBLISHED, "make demo")
    write_text(
        README, replace_block(README.read_text(encoding="utf-8"), "demo", demo_block(PUBLISHED))
    )
    with Image.open(RUN / "reports/contact_sheet.png") as sheet:
        sheet.thumbnail((WIDTH, WIDTH))
        sheet.save("docs/demo.png", optimize=True)


if __name__ == "__main__":
    exit_with_message(main)
