"""Say what is wrong with this working copy, and what mends it.  Changes nothing.

python -m industnerf.doctor              every check but `reproducible`
python -m industnerf.doctor cache store  these

Exit code 1 if something is wrong, else 0.
"""

import argparse
import sys
from pathlib import Path

from rich.console import Console

from industnerf.cli import exit_with_message
from industnerf.doctor import CHECKS, ON_REQUEST, run_check
from industnerf.doctor.findings import Finding
from industnerf.doctor.project_paths import ProjectPaths


def main() -> None:
    listed = "\n".join(
        f"  {name:12} {description}" for name, description in (CHECKS | ON_REQUEST).items()
    )
    parser = argparse.ArgumentParser(
        prog="python -m industnerf.doctor",
        description=f"{__doc__}\nChecks:\n{listed}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("checks", nargs="*", metavar="CHECK")
    paths, console = ProjectPaths.from_root(Path.cwd()), Console(soft_wrap=True, highlight=False)
    num_errors = 0
    for name in parser.parse_args().checks or CHECKS:
        findings = run_check(name, paths)
        num_errors += sum(finding.is_error for finding in findings)
        _print_check(console, paths, name, findings)
    verdict = {0: "nothing is wrong", 1: "1 thing is wrong"}
    console.print(verdict.get(num_errors, f"{num_errors} things are wrong"))
    sys.exit(1 if num_errors else 0)


def _print_check(console: Console, paths: ProjectPaths, name: str, findings: list[Finding]) -> None:
    verdict = "wrong" if any(finding.is_error for finding in findings) else "ok"
    console.print(f"{name:12} {verdict}", markup=False)
    for finding in findings:
        console.print(f"  {paths.shell_words(finding.path)}: {finding.message}", markup=False)
        if finding.fix:
            console.print(f"    mend: {finding.fix}", markup=False)


if __name__ == "__main__":
    exit_with_message(main)
