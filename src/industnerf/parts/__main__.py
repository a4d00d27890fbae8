"""List, export or rebuild the embedded parts; check CAD files of your own.

python -m industnerf.parts list [--set organic]
python -m industnerf.parts build [--family gears]     needs the [cad] extra
python -m industnerf.parts build --set organic        does not
python -m industnerf.parts export PART... | --all --format step|stl|glb|ply|obj --out FOLDER
python -m industnerf.parts check FILES... [--units mm [--override-units]] [--out cad-check]
python -m industnerf.parts card                       docs/reference/dataset.md and its sheets
"""

import argparse
import sys
from dataclasses import replace
from pathlib import Path
from typing import get_args

from rich.console import Console

from industnerf import environment
from industnerf.errors import BadParams, SuiteError
from industnerf.parts.catalogue.build import print_catalogue
from industnerf.parts.catalogue.catalogues import CATALOGUE_FOLDERS
from industnerf.parts.catalogue.entries import EMBEDDED_FOLDER
from industnerf.parts.io.export import FORMATS, export
from industnerf.schema.parts import Units

UNITS = get_args(Units)


def main() -> int:
    arguments = _parser().parse_args()
    console = Console()
    try:
        environment.read_local_file()
        if arguments.command == "list":
            print_catalogue(console, arguments.set)
        elif arguments.command == "export":
            run_export(console, arguments)
        elif arguments.command == "card":
            run_data_card(console)
        elif arguments.command == "check":
            return run_check(console, arguments)
        else:
            from industnerf.parts.catalogue.build import build_catalogue

            build_catalogue(console, arguments.set, arguments.family)
    except SuiteError as error:
        print(f"error: {error}", file=sys.stderr)
        return error.exit_code
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m industnerf.parts",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    commands = parser.add_subparsers(dest="command", required=True)
    list_command = commands.add_parser("list", help="the embedded parts, as a table")
    build_command = commands.add_parser("build", help="draw, check and store them anew")
    build_command.add_argument("--family", help="only this family")
    export_command = commands.add_parser("export", help="parts as files for other programs")
    export_command.add_argument(
        "part_ids", nargs="*", metavar="PART", help="an id that `list` prints"
    )
    export_command.add_argument("--all", action="store_true", help="every part of the set")
    export_command.add_argument("--format", required=True, choices=FORMATS)
    export_command.add_argument("--out", required=True, type=Path, metavar="FOLDER")
    for command in (list_command, build_command, export_command):
        command.add_argument("--set", default="embedded", choices=CATALOGUE_FOLDERS)
    check_command = commands.add_parser("check", help="defects of your own CAD files")
    check_command.add_argument("paths", nargs="+", type=Path, metavar="FILE", help="or folder")
    check_command.add_argument("--units", choices=UNITS, help="of files that state none")
    check_command.add_argument(
        "--override-units", action="store_true", help="--units of all files, whatever they state"
    )
    check_command.add_argument("--split-bodies", action="store_true", help="one row per solid")
    check_command.add_argument("--out", type=Path, default=Path("cad-check"), metavar="FOLDER")
    commands.add_parser("card", help="write docs/reference/dataset.md and its contact sheets")
    return parser


def run_check(console: Console, arguments: argparse.Namespace) -> int:
    """Check files under `find_params`, less what the command line says otherwise."""
    from industnerf.config import find_params, load_params
    from industnerf.parts.validation.check_command import check_cad_files

    params = load_params(find_params())
    settings = replace(
        params.parts,
        units=arguments.units or params.parts.units,
        override_units=arguments.override_units or params.parts.override_units,
        split_bodies=arguments.split_bodies or params.parts.split_bodies,
    )
    return check_cad_files(arguments.paths, replace(params, parts=settings), arguments.out, console)


def run_data_card(console: Console) -> None:
    from industnerf.parts.catalogue.data_card import write_card

    for path in write_card(EMBEDDED_FOLDER.parents[1]):
        console.print(f"wrote {path}")


def run_export(console: Console, arguments: argparse.Namespace) -> None:
    if bool(arguments.part_ids) == arguments.all:
        raise BadParams("export: name the parts to export, or give --all")
    part_ids = None if arguments.all else arguments.part_ids
    export(console, arguments.set, part_ids, arguments.format, arguments.out)


if __name__ == "__main__":
    sys.exit(main())
