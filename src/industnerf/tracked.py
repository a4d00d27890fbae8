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
from industnerf.artifacts.png import read_png
from industnerf.artifacts.renderings import FOLDER
from industnerf.artifacts.views import load_views
from industnerf.splats import splat

POINTS = 200  # of a curve
PREVIEWS = 4  # parts in a picture
ROW = ["part_id", "family", "split", "method"]  # what a row of the table is of
COSTS = ["seconds", "peak_mb"]


def loss_curve(runs: Path, below: str = "*") -> dict[int, float]:
    """Step -> loss, meant over steps and then over the runs: folders in `runs`, or `below` it.

    Steps are gathered into at most POINTS stretches of equal length, each named by its first.
    Empty if the method keeps no history.  Raises BadArtifact if one is torn.
    """
    histories = [History.load(path.parent) for path in sorted(runs.glob(f"{below}/{FILE}"))]
    whole = [history for history in histories if history is not None and len(history.steps)]
    length = max((int(history.steps[-1]) + 1 for history in whole), default=0)
    count = min(POINTS, length)
    rows = [_stretches(history, length, count) for history in whole]
    found = {
        -(-i * length // count): [float(row[i]) for row in rows if np.isfinite(row[i])]
        for i in range(count)
    }
    return {step: fmean(losses) for step, losses in found.items() if losses}


def _stretches(history: History, length: int, count: int) -> Float[np.ndarray, "{count}"]:
    """The mean loss in each of `count` stretches of `length` steps, NaN where there is no step."""
    at = history.steps * count // length
    steps, total = np.bincount(at, minlength=count), np.bincount(at, history.loss, count)
    return np.where(steps > 0, total / np.maximum(steps, 1), np.nan)


def per_part(report: Path) -> Any:
    """A data frame from `scores.csv` and `cost.csv`: a row a part and method, a column a metric.

    With the seconds and the memory of the reconstruction; None where something is not known.
    """
    import pandas as pd

    scores, costs = pd.read_csv(report / "scores.csv"), _reconstructions(report)
    scores["name"] = scores.metric + " " + scores.protocol
    values = scores.pivot(index=ROW, columns="name", values="value")
    status = scores.groupby(ROW).status.min()  # failed, if anything did, comes before ok
    table = values.assign(status=status).reset_index()
    table = table.merge(costs, how="left", on=["part_id", "method"])
    return table.astype(object).where(table.notna(), None)


def mean_costs(report: Path) -> dict[str, float]:
    """`<method>.seconds` and `<method>.peak_mb` -> mean of a reconstruction."""
    means = _reconstructions(report).groupby("method")[COSTS].mean()
    return {
        f"{method}.{name}": float(value)
        for method, row in means.iterrows()
        for name, value in row.items()
    }


def _reconstructions(report: Path) -> Any:
    import pandas as pd

    costs = pd.read_csv(report / "cost.csv")
    return costs[costs.stage == "reconstruct"][["part_id", "method", *COSTS]]


def preview(clouds: Path, views: Path) -> UInt8[np.ndarray, "h w 3"] | None:
    """A few parts from their first held-out camera: left the photograph, right what was made of it.

    That is the rendering, or of a method that does not render the points of the cloud.  None if
    there is no cloud or no held-out camera.  Raises BadArtifact if a file is missing or torn.
    """
    made = [path.parent for path in sorted(clouds.glob("*/cloud.npz"))]
    made = [cloud for cloud in made if load_views(views / cloud.name).held_out.any()]
    chosen = made[:: -(-len(made) // PREVIEWS) or 1]
    rows = [_beside(cloud, views / cloud.name) for cloud in chosen]
    return np.concatenate(rows) if rows else None


def _beside(cloud: Path, views: Path) -> UInt8[np.ndarray, "h w 3"]:
    photographs = load_views(views)
    cameras, first = photographs.cameras, np.flatnonzero(photographs.held_out)[:1]
    rendered = cloud / FOLDER / "rgb" / "000.png"
    if rendered.exists():
        seen = read_png(rendered, cameras.height, cameras.width, "reconstruct")
    else:
        known = Cloud.load(cloud)
        seen = splat(known.points_mm, known.colours, cameras, int(first[0]), cameras.height)
    return np.concatenate([photographs.rgb(first)[0], seen], axis=1)
