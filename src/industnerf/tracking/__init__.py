"""MLflow: a run per study, below it one per method; one per sweep, below it one per point.

Never fatal: the result is safe on disk before it is logged.  One run per distinct result.

INDUSTNERF_MLFLOW    the folder of mlflow.db and mlruns; default: the current one
"""

from industnerf.tracking.database import database_dir, is_enabled, prepare_database
from industnerf.tracking.log import backfill, log_report, log_sweep
from industnerf.tracking.tags import git_state, save_tags

__all__ = [
    "backfill",
    "database_dir",
    "git_state",
    "is_enabled",
    "log_report",
    "log_sweep",
    "prepare_database",
    "save_tags",
]
