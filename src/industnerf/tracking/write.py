"""Write a run and those below it through MLflow's client: in batches, so that it takes seconds."""

import json
import time
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from industnerf.tracking.run import Dataset, Run

TABLE = "per_part.json"
MAX_METRICS, MAX_PARAMS = 900, 100  # of a batch, which MLflow limits to 1000 in all
MAX_PARAM_LENGTH = 6000  # the same
MAX_RUNS = 50_000  # of an answer, by MLflow


def write_run(client: Any, experiment: str, run: Run, parent: str | None = None) -> str:
    """Write `run` below the run `parent`; it is finished once all below it are.  Returns its id."""
    run_id = client.create_run(experiment, tags=_tags(run, parent), run_name=run.name).info.run_id
    _write_values(client, run_id, run)
    _write_files(client, run_id, run)
    for child in run.children:
        write_run(client, experiment, child, run_id)
    client.set_terminated(run_id)
    return run_id


def runs_below(client: Any, experiment: str, run_id: str) -> list[Any]:
    """MLflow's runs right below the run `run_id`."""
    below = f"tags.`mlflow.parentRunId` = '{run_id}'"
    return client.search_runs([experiment], below, max_results=MAX_RUNS)


def delete_run(client: Any, experiment: str, run_id: str) -> None:
    """Delete a run and those below it; `mlflow gc` removes their files."""
    for child in runs_below(client, experiment, run_id):
        delete_run(client, experiment, child.info.run_id)
    client.delete_run(run_id)


def _tags(run: Run, parent: str | None) -> dict[str, str]:
    tags = dict(run.tags)
    if parent:
        tags["mlflow.parentRunId"] = parent
    if "commit" in run.tags:
        tags["mlflow.source.git.commit"] = run.tags["commit"]  # the page's column "Version"
    if run.table is not None:
        tags["mlflow.loggedArtifacts"] = json.dumps([{"path": TABLE, "type": "table"}])
    return tags


def _write_values(client: Any, run_id: str, run: Run) -> None:
    from mlflow.entities import Metric, Param

    timestamp_ms = int(1000 * time.time())
    params = [Param(key, str(value)[:MAX_PARAM_LENGTH]) for key, value in run.params.items()]
    curves = {**{name: {0: value} for name, value in run.metrics.items()}, **run.curves}
    metrics = [
        Metric(name, float(value), timestamp_ms, int(step))
        for name, curve in curves.items()
        for step, value in curve.items()
    ]
    while params or metrics:
        client.log_batch(run_id, metrics[:MAX_METRICS], params[:MAX_PARAMS])
        del metrics[:MAX_METRICS], params[:MAX_PARAMS]
    if run.datasets:
        client.log_inputs(run_id, [_dataset_input(dataset) for dataset in run.datasets])


def _dataset_input(dataset: Dataset) -> Any:
    from mlflow.entities import Dataset as LoggedDataset
    from mlflow.entities import DatasetInput, InputTag

    source = json.dumps({"uri": dataset.source})
    profile = json.dumps({"parts": dataset.num_parts, "families": dataset.num_families})
    logged = LoggedDataset(dataset.name, dataset.digest, "local", source, None, profile)
    return DatasetInput(logged, [InputTag("mlflow.data.context", dataset.context)])


def _write_files(client: Any, run_id: str, run: Run) -> None:
    if run.table is not None:
        with TemporaryDirectory() as folder:
            path = Path(folder, TABLE)
            path.write_text(run.table.to_json(orient="split", index=False), encoding="utf-8")
            client.log_artifact(run_id, str(path))
    if run.preview is not None:
        client.log_image(run_id, run.preview, key="preview", step=0)
    for path, target in run.artifacts:
        log = client.log_artifacts if path.is_dir() else client.log_artifact
        log(run_id, str(path), target or None)
