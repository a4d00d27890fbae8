"""The figures of docs/reference/method.md, from one part's photographs.

python -m industnerf.report.docs.method_figures [PART] [--views data/views] [--out FOLDER]

The photographs are what `dvc repro views` writes; the settings are those of params.yaml, and the
seed that of the study, so this is the study's own run.
"""

import argparse
import sys
from pathlib import Path

from industnerf.cli import exit_with_message
from industnerf.torch_kernels import use_reproducible_kernels

DEFAULT_PART = "handwheel-din950-d160"  # holes, thin bars, and two colors


def main() -> None:
    parser = argparse.ArgumentParser(
        prog="python -m industnerf.report.docs.method_figures",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "part", nargs="?", default=DEFAULT_PART, metavar="PART", help=f"default: {DEFAULT_PART}"
    )
    parser.add_argument("--views", type=Path, default=Path("data/views"), metavar="FOLDER")
    parser.add_argument("--out", type=Path, default=Path("docs/reference/method"), metavar="FOLDER")
    arguments = parser.parse_args()
    exit_with_message(lambda: write_part_figures(arguments.views / arguments.part, arguments.out))


def write_part_figures(views: Path, out: Path) -> None:
    """Run the method on the photographs in `views`; replace the figures in `out`."""

    from industnerf.report.docs.method_figures.figures import trace_part, write_figures

    use_reproducible_kernels()  # as the study does: same seed, same bytes
    for path in write_figures(trace_part(views), out):
        print(f"wrote {path}")


if __name__ == "__main__":
    sys.exit(main())
