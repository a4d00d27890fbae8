"""Publish the demo in results/demo, and bring its table and picture into the README: `make readme`.

The README has columns of its Table 1, which the test suite makes anew of its scores.
"""

from pathlib import Path

from PIL import Image

from industnerf.artifacts.files import write_text
from industnerf.cli import exit_with_message
from industnerf.report.docs.markdown_blocks import replace_block
from industnerf.report.docs.readme_tables import demo_block
from pipeline.publish import publish_run

MAX_WIDTH_PX = 2200  # px of the picture
README, RUN_DIR, RESULTS_DIR = Path("README.md"), Path("runs/demo"), Path("results/demo")


def main() -> None:
    publish_run(RUN_DIR, RESULTS_DIR, "make demo")
    write_text(
        README, replace_block(README.read_text(encoding="utf-8"), "demo", demo_block(RESULTS_DIR))
    )
    with Image.open(RUN_DIR / "reports/contact_sheet.png") as sheet:
        sheet.thumbnail((MAX_WIDTH_PX, MAX_WIDTH_PX))
        sheet.save("docs/demo.png", optimize=True)


if __name__ == "__main__":
    exit_with_message(main)
