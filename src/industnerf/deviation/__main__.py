"""Where a part deviates from its CAD file: a color map in mm that opens offline.

python -m industnerf.deviation cloud.ply part.step --tolerance 0.2

The cloud is moved onto the CAD file, wherever it lies; --in-place leaves it.  Written into the
current folder: a page with map and histogram, the points with their deviation as CSV, and the
numbers and the move as JSON.  A deviation is positive where the cloud is outside the CAD surface.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import get_args

from industnerf.cli import exit_with_message
from industnerf.schema.parts import Units


def main(arguments: Sequence[str]) -> None:
    args = _parser().parse_args(arguments)
    from industnerf.deviation.deviation_map import deviation_map  # late: --help needs none of it

    deviation_map(**vars(args))


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m industnerf.deviation",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "cloud", type=Path, metavar="CLOUD", help="or mesh, as pipeline.score reads"
    )
    parser.add_argument("cad", type=Path, metavar="CAD", help="of any format of `parts check`")
    parser.add_argument(
        "--tolerance", type=_positive, default=0.5, metavar="MM", help="that is allowed (0.5)"
    )
    parser.add_argument(
        "--units", choices=get_args(Units), default="mm", help="of the cloud's numbers (mm)"
    )
    parser.add_argument(
        "--cad-units", choices=get_args(Units), default="mm", help="of a CAD file that states none"
    )
    parser.add_argument(
        "--with-scale", action="store_true", help="fit the scale too: no size error shows then"
    )
    parser.add_argument("--in-place", action="store_true", help="do not move the cloud")
    parser.add_argument(
        "--max-distance",
        type=_positive,
        metavar="MM",
        help="beyond which a point is a stray (5 %% of the diagonal)",
    )
    parser.add_argument(
        "--out", type=Path, metavar="PAGE.html", help="default: CLOUD.deviation.html"
    )
    parser.add_argument("--png", action="store_true", help="also a picture, beside the page")
    return parser


def _positive(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"{text!r} is no number above 0")
    return value


if __name__ == "__main__":
    exit_with_message(lambda: main(sys.argv[1:]))
