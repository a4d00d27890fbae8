"""Log reports and sweeps: once per distinct result, and never at the price of one."""

import os
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from industnerf.config import read_yaml
from industnerf.tracking import sweep
from industnerf.tracking.database import is_enabled, open_locked
from industnerf.tracking.report import Report
from industnerf.tracking.run import Run
from industnerf.tracking.study import study_run
from industnerf.tracking.views import sweep_view, view_tag
from industnerf.tracking.write import delete_run, runs_below, write_run


def log_report(report: Path, params: Mapping[str, Any]) -> None:
    """Log the report in `report`, unless one with the same results is there.

    Not that of a point of a sweep, which `log_sweep` logs: where the points run on a cluster, many
    machines would write to one SQLite.
    """
    if (report.absolute().parent.parent / sweep.MARK).exists():
        return
    _log_safely(report, lambda: study_run(Report(report, params)))


def log_sweep(folder: Path) -> None:
    """Log the sweep in `folder`, its finished points; in place of what it had of fewer."""
    _log_safely(folder, lambda: sweep.sweep_run(folder))


def backfill(root: Path) -> None:
    """Log every report and sweep in and below `root`; says which one cannot be."""
    for name, below, files in os.walk(root):
        folder = Path(name)
        if sweep.MARK in files:
            log_sweep(folder)
            below.clear()
        elif {"scores.csv", "table1.csv"} <= set(files):
            _log_safely(folder, lambda folder=folder: study_run(Report(folder, _params(folder))))
        below[:] = sorted(set(below) - {"data"})  # a folder per part


def _params(report: Path) -> dict[str, Any]:
    """Those of a report of this working copy, or a published one; empty if they are not kept."""
    paths = (report.parent / "params.yaml", report / "params.yaml")
    return next((read_yaml(path) for path in paths if path.exists()), {})


def _log_safely(folder: Path, make_run: Callable[[], Run | None]) -> None:
    if not is_enabled():
        return
    try:
        with open_locked() as (client, experiment):
            _delete_interrupted(client, experiment)
            run = make_run()
            if run and not _is_logged(client, experiment, run):
                run_id = write_run(client, experiment, run)
                if run.tags["kind"] == "sweep":
                    _delete_superseded(client, experiment, run_id, run.tags["folder"])
                    tag = view_tag(run.tags["view"])
                    view = sweep_view(run.name, run_id, run.tags["swept"].split())
                    client.set_experiment_tag(experiment, tag, view)
    except Exception as error:  # whatever MLflow or SQLite throws, the results are on disk
        print(
            f"MLflow: not logged ({type(error).__name__}: {error}). The result is safe in {folder};"
            " `make ui` logs it later; if that fails too, `python -m industnerf.doctor database`"
            " says what mends it.",
            file=sys.stderr,
        )


def _is_logged(client: Any, experiment: str, run: Run) -> bool:
    same = f"tags.kind = '{run.tags['kind']}' AND tags.results = '{run.tags['results']}'"
    return bool(client.search_runs([experiment], same, max_results=1))


def _delete_interrupted(client: Any, experiment: str) -> None:
    """Delete what another process began and did not finish: it does not hold the lock any more."""
    for run in client.search_runs([experiment], "attributes.status != 'FINISHED'"):
        if run.data.tags.get("kind") in ("study", "sweep"):
            delete_run(client, experiment, run.info.run_id)


def _delete_superseded(client: Any, experiment: str, run_id: str, folder: str) -> None:
    """Delete what was logged of the sweep in `folder` when fewer of its points were finished."""
    points = _points(client, experiment, run_id)
    for run in client.search_runs([experiment], "tags.kind = 'sweep'"):
        is_earlier = run.data.tags["folder"] == folder and run.info.run_id != run_id
        if is_earlier and _points(client, experiment, run.info.run_id) <= points:
            delete_run(client, experiment, run.info.run_id)


def _points(client: Any, experiment: str, sweep_id: str) -> set[tuple[str | None, ...]]:
    below = runs_below(client, experiment, sweep_id)
    return {tuple(run.data.tags.get(name) for name in ("results", "point")) for run in below}
