"""Write docs/reference/hyperparameters.md: python -m industnerf.report.docs.hyperparameters"""

from pathlib import Path

from industnerf.artifacts.files import write_text
from industnerf.cli import exit_with_message
from industnerf.config import PARAMS, load_stages, read_yaml
from industnerf.report.docs.hyperparameters.document import render_document

OUT = Path("docs/reference/hyperparameters.md")


def main() -> None:
    write_text(
        OUT, render_document(PARAMS.read_text(encoding="utf-8"), read_yaml(PARAMS), load_stages())
    )
    print(f"wrote {OUT}")


if __name__ == "__main__":
    exit_with_message(main)
