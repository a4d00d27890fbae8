"""What MLflow is given of a run beside its means: little, so that its pages stay quick.

A loss curve and a picture for every method that has them, and one table for all methods.
"""

from pathlib import Path
from statistics import fmean
from typing import Any

import numpy as np
from jaxtyping import Float, UInt8

from industnerf.artifacts.cloud import Cloud
from industnerf.artifacts.history import FILE, History
from industnerf.artifacts.renderings import Renderings
from industnerf.artifacts.views import load_views
from industnerf.splats import splat

MAX_CURVE_POINTS = 200  # of a curve
MAX_PREVIEW_PARTS = 4  # parts in a picture
INDEX_COLUMNS = ["part_id", "family", "split", "method"]  # what a row of the table is of
COST_COLUMNS = ["seconds", "peak_mb"]


def loss_curve(runs: Path, pattern: str = "*") -> dict[int, float]:
    """Step -> loss, the mean over steps and then over the runs: folders in `runs` of `pattern`.

    Steps are gathered into at most MAX_CURVE_POINTS stretches of equal length, each named by
    its first.
    Empty if the method keeps no history.  Raises BadArtifact if one is torn.
    """
    histories = [History.load(path.parent) for path in sorted(runs.glob(f"{pattern}/{FILE}"))]
    nonempty = [history for history in histories if history is not None and len(history.steps)]
    length = max((int(history.steps[-1]) + 1 for history in nonempty), default=0)
    count = min(MAX_CURVE_POINTS, length)
    binned = [_binned_means(history, length, count) for history in nonempty]
    curve = {
        -(-i * length // count): [float(means[i]) for means in binned if np.isfinite(means[i])]
        for i in range(count)
    }
    return {step: fmean(losses) for step, losses in curve.items() if losses}


def _binned_means(history: History, length: int, count: int) -> Float[np.ndarray, "{count}"]:
    """The mean loss in each of `count` stretches of `length` steps, NaN where there is no step."""
    bins = history.steps * count // length
    counts, total = np.bincount(bins, minlength=count), np.bincount(bins, history.loss, count)
    return np.where(counts > 0, total / np.maximum(counts, 1), np.nan)


def per_part_table(report: Path) -> Any:
    """A data frame from `scores.csv` and `cost.csv`: a row a part and method, a column a metric.

    With the seconds and the memory of the reconstruction; None where something is not known.
    """
    import pandas as pd

    scores, costs = pd.read_csv(report / "scores.csv"), _reconstruction_costs(report)
    scores["name"] = scores.metric + " " + scores.protocol
    values = scores.pivot(index=INDEX_COLUMNS, columns="name", values="value")
    status = scores.groupby(INDEX_COLUMNS).status.min()  # failed, if anything did, comes before ok
    table = values.assign(status=status).reset_index()
    table = table.merge(costs, how="left", on=["part_id", "method"])
    return table.astype(object).where(table.notna(), None)


def mean_costs(report: Path) -> dict[str, float]:
    """`<method>.seconds` and `<method>.peak_mb` -> mean of a reconstruction."""
    means = _reconstruction_costs(report).groupby("method")[COST_COLUMNS].mean()
    return {
        f"{method}.{name}": float(value)
        for method, row in means.iterrows()
        for name, value in row.items()
    }


def _reconstruction_costs(report: Path) -> Any:
    import pandas as pd

    costs = pd.read_csv(report / "cost.csv")
    return costs[costs.stage == "reconstruct"][["part_id", "method", *COST_COLUMNS]]


def preview_image(clouds: Path, views: Path) -> UInt8[np.ndarray, "h w 3"] | None:
    """A few parts from their first held-out camera: left the photograph, right what was made of it.

    That is the rendering, or of a method that does not render the points of the cloud.  None if
    there is no cloud or no held-out camera.  Raises BadArtifact if a file is missing or torn.
    """
    clouds_with_views = [path.parent for path in sorted(clouds.glob("*/cloud.npz"))]
    clouds_with_views = [
        cloud for cloud in clouds_with_views if load_views(views / cloud.name).held_out.any()
    ]
    selected = clouds_with_views[:: -(-len(clouds_with_views) // MAX_PREVIEW_PARTS) or 1]
    rows = [_side_by_side(cloud, views / cloud.name) for cloud in selected]
    return np.concatenate(rows) if rows else None


def _side_by_side(cloud: Path, views: Path) -> UInt8[np.ndarray, "h w 3"]:
    view_set = load_views(views)
    cameras, first = view_set.cameras, np.flatnonzero(view_set.held_out)[:1]
    rendering = Renderings.load_first_rgb(cloud)
    if rendering is None:
        loaded_cloud = Cloud.load(cloud)
        rendering = splat(
            loaded_cloud.points_mm, loaded_cloud.colors, cameras, int(first[0]), cameras.height
        )
    return np.concatenate([view_set.rgb(first)[0], rendering], axis=1)
