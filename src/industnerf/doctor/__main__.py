"""Say what is wrong with this working copy, and what mends it.  Changes nothing.

python -m industnerf.doctor              every check
python -m industnerf.doctor cache gpu    these

Exit code 1 if something is wrong, else 0.
"""

import argparse
import sys
from pathlib import Path

from rich.console import Console

from industnerf.cli import exit_with_message
from industnerf.doctor import CHECKS, examine
from industnerf.doctor.findings import Finding
from industnerf.doctor.places import Places


def main() -> None:
    listed = "\n".join(f"  {name:12} {about}" for name, about in CHECKS.items())
    parser = argparse.ArgumentParser(
        prog="python -m industnerf.doctor",
        description=f"{__doc__}\nChecks:\n{listed}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("checks", nargs="*", metavar="CHECK")
    places, console = Places.of(Path.cwd()), Console(soft_wrap=True, highlight=False)
    wrong = 0
    for name in parser.parse_args().checks or CHECKS:
        found = examine(name, places)
        wrong += sum(finding.is_wrong for finding in found)
        _show(console, places, name, found)
    verdict = {0: "nothing is wrong", 1: "1 thing is wrong"}
    console.print(verdict.get(wrong, f"{wrong} things are wrong"))
    sys.exit(1 if wrong else 0)


def _show(console: Console, places: Places, name: str, found: list[Finding]) -> None:
    verdict = "wrong" if any(finding.is_wrong for finding in found) else "ok"
    console.print(f"{name:12} {verdict}", markup=False)
    for finding in found:
        console.print(f"  {places.words(finding.where)}: {finding.what}", markup=False)
        if finding.mend:
            console.print(f"    mend: {finding.mend}", markup=False)


if __name__ == "__main__":
    exit_with_message(main)
