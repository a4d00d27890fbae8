"""The views that MLflow's page offers, in its own format of a saved view: JSON in a tag.

A table sorted by EMD, and charts that compare methods; `Views` on the page lists them by name.
"""

import json
from collections.abc import Sequence
from typing import Any

METHODS = "methods"  # the key of the view of all studies' methods, as an address names it
METRICS = ("emd", "emd_ratio", "seconds", "peak_mb", "failures", "parts")
COLUMN_PX = 100
COMPARISON = "Comparison"  # the section of our charts; MLflow adds one of each other metric
# In this order, with the last ones closed: of what they hold there is a chart per metric.
SECTIONS = {COMPARISON: True, "part": True, "loss": True, "Model metrics": False, "dev": False}
METHODS_FILTER = "tags.kind = 'method'"


def view_tag(key: str) -> str:
    """The experiment's tag that holds the view `key`."""
    return f"mlflow.sharedViewState.{key}"


def view_address(server: str, experiment: str, key: str) -> str:
    """Where the browser shows the view `key`."""
    return f"{server}/#/experiments/{experiment}/runs?viewStateShareKey={key}"


def methods_view() -> str:
    """All methods of all studies."""
    tags = ("preset", "scope", "inputs")
    return _view("Methods, smallest EMD first", METHODS_FILTER, (), tags)


def sweep_view(name: str, run_id: str, swept: Sequence[str]) -> str:
    """The points of the sweep whose run is `run_id`, with the parameters that were swept."""
    return _view(name, f"tags.`mlflow.parentRunId` = '{run_id}'", ("method", *swept), ())


def _view(name: str, only: str, params: Sequence[str], tags: Sequence[str]) -> str:
    columns = [
        *(f"params.`{one}`" for one in params),
        *(f"metrics.`{one}`" for one in METRICS),
        *(f"tags.`{one}`" for one in tags),
    ]
    state = {
        "searchFilter": only,
        "orderByKey": "metrics.`emd`",
        "orderByAsc": True,
        "selectedColumns": columns,
        "columnOrder": columns,
        "columnWidths": dict.fromkeys(columns, COLUMN_PX),
        "runsHiddenMode": "FIRST_20_RUNS",  # all methods of a study are drawn
        "isAccordionReordered": True,
        "compareRunSections": [
            {"uuid": section, "name": section, "display": is_open, "isReordered": True}
            for section, is_open in SECTIONS.items()
        ],
        "compareRunCharts": [
            {"uuid": f"{COMPARISON} {i}", "metricSectionId": COMPARISON, "deleted": False} | chart
            for i, chart in enumerate(_charts(params))
        ],
    }
    return json.dumps({"name": name, "createdAt": 0, "updatedAt": 0, "state": json.dumps(state)})


def _charts(params: Sequence[str]) -> list[dict[str, Any]]:
    return [
        _bars("emd"),
        {
            "type": "SCATTER",
            "displayName": "EMD against seconds a part",
            "xaxis": {"key": "seconds", "type": "METRIC"},
            "yaxis": {"key": "emd", "type": "METRIC"},
            "runsCountToCompare": 100,
        },
        {
            "type": "PARALLEL",
            "displayName": "Parallel coordinates",
            "selectedParams": list(params) or ["method"],
            "selectedMetrics": ["seconds", "peak_mb", "emd"],
            "showAllRuns": True,
        },
        _bars("emd_ratio"),
        _bars("seconds"),
        {
            "type": "IMAGE",
            "displayName": "Photograph, and what was made of it",
            "imageKeys": ["preview"],
            "step": 0,
        },
    ]


def _bars(metric: str) -> dict[str, Any]:
    return {
        "type": "BAR",
        "displayName": metric,
        "metricKey": metric,
        "isGenerated": True,
        "runsCountToCompare": 20,
    }
