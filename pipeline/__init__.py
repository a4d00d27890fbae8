"""`stages/` has one script for each stage of dvc.yaml; beside it are the commands that users type.

Paths and names are here, arithmetic is in src/.
"""

import sys
from pathlib import Path

# A checkout beside the one that is installed, as DVC makes for a queued experiment, runs its own
# code; and the code is part of every key.
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "src"))

from industnerf.errors import BAD_INPUT
from industnerf.renamed import COMMANDS

if sys.argv[0] == "-m":  # which it is until Python has found the module to run
    command = sys.orig_argv[sys.orig_argv.index("-m") + 1]
    if command in COMMANDS:
        print(f"error: python -m {command} is now python -m {COMMANDS[command]}", file=sys.stderr)
        sys.exit(BAD_INPUT)
