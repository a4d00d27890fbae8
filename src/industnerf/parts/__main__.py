"""List the embedded parts, or draw and bake them anew.

python -m industnerf.parts list
python -m industnerf.parts build [--family gears]     needs the [cad] extra
"""

import argparse
import os
import sys

from rich.console import Console
from rich.progress import track
from rich.table import Table

from industnerf.errors import SuiteError
from industnerf.parts.catalogue import EMBEDDED, catalogue


def main() -> int:
    parser = argparse.ArgumentParser(
        prog="python -m industnerf.parts",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    commands = parser.add_subparsers(dest="command", required=True)
    commands.add_parser("list", help="the baked parts, as a table")
    build_command = commands.add_parser("build", help="draw, check and bake them anew")
    build_command.add_argument("--family", help="only this family")
    arguments = parser.parse_args()
    console = Console()
    try:
        return show(console) if arguments.command == "list" else build(console, arguments.family)
    except SuiteError as error:
        print(error, file=sys.stderr)
        return 1


def show(console: Console) -> int:
    entries = catalogue()
    table = Table(
        title=f"{len(entries)} parts in {len({entry.family for entry in entries})} families"
    )
    for heading in ("part", "designation", "family", "drawn with"):
        table.add_column(heading)
    for heading in ("size, mm", "volume, cm³", "faces", "bodies"):
        table.add_column(heading, justify="right")
    for entry in entries:
        size = " x ".join(f"{side:.1f}" for side in entry.extents_mm)
        counts = (f"{entry.volume_mm3 / 1000:.2f}", str(entry.faces), str(entry.bodies))
        table.add_row(entry.id, entry.designation, entry.family, entry.library, size, *counts)
    console.print(table)
    return 0


def build(console: Console, family: str | None) -> int:
    try:
        from industnerf.parts import bake
    except ModuleNotFoundError as error:
        print(
            f"{error}: drawing parts needs the CAD extra, `pip install -e .[cad]`", file=sys.stderr
        )
        return 1
    if family is not None and family not in bake.FAMILIES:
        print(f"no family {family!r}, only {', '.join(bake.FAMILIES)}", file=sys.stderr)
        return 1
    parts = [
        (name, recipe)
        for name, recipes in bake.FAMILIES.items()
        for recipe in recipes
        if family in (None, name)
    ]
    outcomes = bake.bake_all(parts, workers=len(os.sched_getaffinity(0)))
    finished = list(track(outcomes, "Baking", total=len(parts), console=console))
    baked = [outcome.answer for outcome in finished if isinstance(outcome.answer, bake.Baked)]
    failed = [outcome for outcome in finished if isinstance(outcome.answer, str)]
    bake.write(baked, EMBEDDED)
    for outcome in failed:
        print(f"{outcome.part_id}: {outcome.answer}", file=sys.stderr)
    console.print(f"{len(baked)} of {len(parts)} parts baked into {EMBEDDED}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
