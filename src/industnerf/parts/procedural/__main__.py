"""List the kinds of procedural solids, draw their contact sheet, or write solids as STL.

python -m industnerf.parts.procedural list
python -m industnerf.parts.procedural sheet [--out docs/reference/procedural.png]
python -m industnerf.parts.procedural export --count 20 --out FOLDER
"""

import argparse
from functools import partial
from pathlib import Path

from industnerf.cli import exit_with_message
from industnerf.errors import BadParams
from industnerf.parts.procedural.kinds import ALL_KINDS, KINDS, RESEMBLING_KINDS

SHEET = Path("docs/reference/procedural.png")
SOLIDS_A_KIND = 3
KINDS_A_ROW = 3


def main() -> None:
    arguments = _parser().parse_args()
    if arguments.command == "list":
        exit_with_message(print_kinds)
    elif arguments.command == "sheet":
        exit_with_message(partial(write_sheet, arguments.out, arguments.seed))
    else:
        exit_with_message(
            partial(export, arguments.out, arguments.seed, arguments.count, arguments.kinds)
        )


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m industnerf.parts.procedural",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    commands = parser.add_subparsers(dest="command", required=True)
    commands.add_parser("list", help="the kinds, and the families that some resemble")
    sheet = commands.add_parser("sheet", help=f"{SOLIDS_A_KIND} solids of each kind on a picture")
    sheet.add_argument("--out", type=Path, default=SHEET, metavar="PNG")
    stl = commands.add_parser("export", help="solids as STL files, their longest edge 100 mm")
    stl.add_argument("--count", type=int, default=20)
    stl.add_argument("--kinds", nargs="+", default=ALL_KINDS, metavar="KIND")
    stl.add_argument("--out", type=Path, required=True, metavar="FOLDER")
    for command in (sheet, stl):
        command.add_argument("--seed", type=int, default=0)
    return parser


def print_kinds() -> None:
    print(kinds_table())


def kinds_table() -> str:
    """Name, description and family of every kind, in Markdown."""
    rows = ["| kind | what it is | resembles |", "| --- | --- | --- |"]
    rows += [
        f"| `{kind}` | {describe(kind)} | {RESEMBLING_KINDS.get(kind, '')} |" for kind in KINDS
    ]
    return "\n".join(rows)


def describe(kind: str) -> str:
    """What a kind is: the first sentence of its docstring."""
    return " ".join((KINDS[kind].__doc__ or "").split()).partition(". ")[0].rstrip(".")


def write_sheet(path: Path, seed: int) -> None:
    """Solids 0, 1, ... of `seed`, of each kind, on one picture."""
    from industnerf.parts.contact_sheet import render_tile, write_contact_sheet
    from industnerf.parts.procedural.solid import procedural_solid

    tiles = []
    for kind in ALL_KINDS:
        for index in range(SOLIDS_A_KIND):
            solid = procedural_solid(seed, index, (kind,))
            tiles.append(render_tile(_caption(kind, index), *solid.as_mesh()))
    path.parent.mkdir(parents=True, exist_ok=True)
    write_contact_sheet(tiles, path, SOLIDS_A_KIND * KINDS_A_ROW)
    print(f"wrote {path}: {len(tiles)} solids")


def _caption(kind: str, index: int) -> str:
    """The name under the middle one; below it the family that it resembles."""
    if index != SOLIDS_A_KIND // 2:
        return ""
    return f"{kind}\n{RESEMBLING_KINDS.get(kind, '')}"


def export(folder: Path, seed: int, count: int, kinds: tuple[str, ...]) -> None:
    """Write the first `count` solids of `seed`, 100 mm long, named by number and kind."""
    from industnerf.parts.io.writers.mesh_formats import write_stl
    from industnerf.parts.procedural.solid import procedural_solid

    if count < 1:
        raise BadParams(f"export --count {count}: at least 1")
    folder.mkdir(parents=True, exist_ok=True)
    for index in range(count):
        solid = procedural_solid(seed, index, kinds)
        write_stl(folder / f"{index:05d}-{solid.kind}.stl", *solid.as_mesh(100.0))
    print(f"wrote {count} solids to {folder}")


if __name__ == "__main__":
    main()
