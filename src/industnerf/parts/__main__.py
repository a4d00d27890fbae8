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

from industnerf.errors import BadParams, BadPart, SuiteError
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
        if arguments.command == "list":
            show(console)
        else:
            build(console, arguments.family)
    except SuiteError as error:
        print(error, file=sys.stderr)
        return 1
    return 0


def show(console: Console) -> None:
    entries = catalogue()
    families = {entry.family for entry in entries}
    table = Table(title=f"{len(entries)} parts in {len(families)} families")
    for heading in ("part", "designation", "family", "drawn with"):
        table.add_column(heading)
    for heading in ("size, mm", "volume, cm³", "faces", "bodies"):
        table.add_column(heading, justify="right")
    for entry in entries:
        size = " x ".join(f"{side:.1f}" for side in entry.extents_mm)
        counts = (f"{entry.volume_mm3 / 1000:.2f}", str(entry.faces), str(entry.bodies))
        table.add_row(entry.id, entry.designation, entry.family, entry.library, size, *counts)
    console.print(table)


def build(console: Console, family: str | None) -> None:
    """Bake all parts or those of one family; if one fails, nothing is written."""
    try:
        from industnerf.parts import bake
    except ModuleNotFoundError as error:
        raise SuiteError(
            f"drawing parts needs the CAD libraries ({error}): `pip install -e '.[cad]'`"
        ) from error
    if family is not None and family not in bake.FAMILIES:
        raise BadParams(f"--family: no family {family!r}, only {', '.join(bake.FAMILIES)}")
    parts = [
        (name, recipe)
        for name, recipes in bake.FAMILIES.items()
        for recipe in recipes
        if family in (None, name)
    ]
    outcomes = bake.bake_all(parts, workers=len(os.sched_getaffinity(0)))
    finished = list(track(outcomes, "Baking", total=len(parts), console=console))
    failed = [f"{done.part_id}: {done.answer}" for done in finished if isinstance(done.answer, str)]
    if failed:
        raise BadPart("\n".join([*failed, f"{len(failed)} parts failed; nothing was written"]))
    kept = [entry for entry in catalogue() if entry.family != family] if family else []
    bake.write([done.answer for done in finished], kept, EMBEDDED)
    console.print(f"{len(finished)} parts baked into {EMBEDDED}")


if __name__ == "__main__":
    sys.exit(main())
