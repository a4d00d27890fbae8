"""Bring MLflow up to date; print where its database is, and which page of `make ui` to open.

python -m industnerf.tracking                  the reports of this working copy
python -m industnerf.tracking results/study    a report elsewhere, or all below a folder
"""

import os
import sys
from pathlib import Path

from industnerf.cli import exit_with_message
from industnerf.errors import BadParams
from industnerf.tracking.database import check_database, database_dir, is_enabled
from industnerf.tracking.log import backfill
from industnerf.tracking.views import METHODS, view_address


def main() -> None:
    if "--help" in sys.argv or "-h" in sys.argv:
        print(__doc__)
        return
    if not is_enabled():
        raise BadParams("INDUSTNERF_MLFLOW is off: there is nothing to look at")
    experiment = check_database()
    for folder in sys.argv[1:] or ["reports", "runs"]:
        backfill(Path(folder))
    server = f"http://127.0.0.1:{os.environ.get('MLFLOW_PORT', '5000')}"
    print(f"open {view_address(server, experiment, METHODS)}", file=sys.stderr)
    print("`Views` on that page has a view of every sweep", file=sys.stderr)
    print(f"sqlite:///{database_dir() / 'mlflow.db'}")


if __name__ == "__main__":
    exit_with_message(main)
