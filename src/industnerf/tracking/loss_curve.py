"""Loss curves, thinned so that MLflow's charts stay quick."""

from pathlib import Path
from statistics import fmean

import numpy as np
from jaxtyping import Float

from industnerf.artifacts.history import FILE, History

MAX_CURVE_POINTS = 200  # of a curve


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
