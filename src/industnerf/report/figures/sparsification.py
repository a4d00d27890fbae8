"""Sparsification curves: does the error fall when points of low confidence are removed?"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from industnerf.artifacts.scores import PartScore
from industnerf.methods import MODULES
from industnerf.report.figures.figure_style import encode_png, new_figure
from industnerf.report.study import Study
from industnerf.report.tables.scores import scores_of, select_scores

COLORS = ("#30638e", "#d1495b", "#edae49", "#66a182", "#8d6a9f")
ERROR_LEFT_PREFIX = "error_left_"  # after so many per cent are removed


@dataclass(frozen=True)
class SparsificationCurve:
    """Mean error of the remaining candidates over that of all; the mean over parts."""

    removed: Float[np.ndarray, "s"]  # per cent of the candidates
    by_confidence: Float[np.ndarray, "s"]
    by_error: Float[np.ndarray, "s"]  # the lower bound of any order
    parts: int


def sparsification_curves(study: Study) -> dict[str, SparsificationCurve]:
    """The curve of every method that has one, over its test parts."""
    metrics = dict.fromkeys(row.score.metric for row in study.scores)
    removed = sorted(
        int(name.removeprefix(ERROR_LEFT_PREFIX))
        for name in metrics
        if name.startswith(ERROR_LEFT_PREFIX)
    )
    by_method = {
        method: _curve(scores_of(study, method, "test"), removed) for method in study.methods
    }
    return {method: curve for method, curve in by_method.items() if curve}


def _curve(scores: list[PartScore], removed: list[int]) -> SparsificationCurve | None:
    steps = [
        select_scores(scores, f"{ERROR_LEFT_PREFIX}{percent}", "P1-near") for percent in removed
    ]
    if not steps or not all(steps):
        return None
    errors = [np.mean([row.score.value for row in step]) for step in steps]
    oracle_errors = [np.mean([row.score.floor for row in step]) for step in steps]
    return SparsificationCurve(
        np.array([0.0, *removed]),
        np.array([1.0, *errors]),
        np.array([1.0, *oracle_errors]),
        len(steps[0]),
    )


def plot_sparsification(study: Study) -> bytes | None:
    """A PNG of all curves; None if there is none."""
    by_method = sparsification_curves(study)
    if not by_method:
        return None
    fig = new_figure(7.2, 4.0)
    axis = fig.subplots()
    axis.set(
        xlabel="candidates removed, the least confident first, %",
        ylabel="mean error of the rest / of all",
    )
    axis.axhline(1, color="#9aa4af", lw=1, label="a random order")
    for method, curve in by_method.items():
        color = COLORS[list(MODULES).index(method) % len(COLORS)]  # in every figure the same
        axis.plot(curve.removed, curve.by_confidence, "o-", ms=3, color=color, label=method)
        axis.plot(curve.removed, curve.by_error, "--", lw=1, color=color)
    axis.plot([], [], "--", lw=1, color="#57606a", label="the true error's order")
    axis.set_ylim(bottom=0)
    axis.grid(color="#eaeef2")
    axis.spines[["top", "right"]].set_visible(False)
    axis.legend(frameon=False, fontsize=8)
    return encode_png(fig)
