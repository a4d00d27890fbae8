"""Look at clouds and meshes: one page with a 3-D viewer that opens offline.

python -m industnerf.view cloud.ply               writes cloud.ply.html into the current folder
python -m industnerf.view a.ply b.step --open     side by side under one camera, in the browser

Every format that `pipeline.score` takes is read.  Of several clouds each is also colored by its
distance to the other, or to the first.  Lengths are in the unit of the files.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from industnerf.cli import exit_with_message


def main(arguments: Sequence[str]) -> None:
    args = _parser().parse_args(arguments)
    from industnerf.view.quick_look import quick_look  # late: --help needs none of it

    quick_look(args.clouds, args.out, args.png, args.min_opacity, args.open)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m industnerf.view",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("clouds", nargs="+", type=Path, metavar="CLOUD", help="or mesh")
    parser.add_argument(
        "--out", type=Path, metavar="PAGE.html", help="default: the first file's name and .html"
    )
    parser.add_argument(
        "--png", action="store_true", help="also a picture from four sides, beside the page"
    )
    parser.add_argument("--open", action="store_true", help="open the page in the browser")
    parser.add_argument(
        "--min-opacity",
        type=float,
        default=0.0,
        metavar="X",
        help="of Gaussian splats, the least that is shown (0)",
    )
    return parser


if __name__ == "__main__":
    exit_with_message(lambda: main(sys.argv[1:]))
