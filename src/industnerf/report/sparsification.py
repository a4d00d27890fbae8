"""Sparsification curves: is what a method is unsure of also what is wrong?"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from industnerf.artifacts.scores import PartScore
from industnerf.report.gather import Study
from industnerf.report.lookup import only, scores_of
from industnerf.report.plates import figure, png

COLOURS = ("#30638e", "#d1495b", "#edae49", "#66a182", "#8d6a9f")
LEFT = "error_left_"  # after so many per cent are removed


@dataclass(frozen=True)
class Curve:
    """Mean error of what is left, in units of that of all; the mean over parts."""

    removed: Float[np.ndarray, "s"]  # per cent of the candidates
    by_confidence: Float[np.ndarray, "s"]
    by_error: Float[np.ndarray, "s"]  # what no order is below
    parts: int


def curves(study: Study) -> dict[str, Curve]:
    """Of every method that was asked, over its test parts."""
    names = dict.fromkeys(row.score.metric for row in study.scores)
    removed = sorted(int(name.removeprefix(LEFT)) for name in names if name.startswith(LEFT))
    found = {method: _curve(scores_of(study, method, "test"), removed) for method in study.methods}
    return {method: curve for method, curve in found.items() if curve}


def _curve(scores: list[PartScore], removed: list[int]) -> Curve | None:
    steps = [only(scores, f"{LEFT}{percent}", "P1-near") for percent in removed]
    if not steps or not all(steps):
        return None
    left = [np.mean([row.score.value for row in step]) for step in steps]
    best = [np.mean([row.score.floor for row in step]) for step in steps]
    return Curve(
        np.array([0.0, *removed]), np.array([1.0, *left]), np.array([1.0, *best]), len(steps[0])
    )


def sparsification(study: Study) -> bytes | None:
    """A PNG of all `curves`, None if there is none."""
    found = curves(study)
    if not found:
        return None
    drawn = figure(7.2, 4.0)
    axis = drawn.subplots()
    axis.set(
        xlabel="candidates removed, the least sure first, %",
        ylabel="mean error of what is left / of all",
    )
    axis.axhline(1, color="#9aa4af", lw=1, label="a random order")
    for number, (method, curve) in enumerate(found.items()):
        colour = COLOURS[number % len(COLOURS)]
        axis.plot(curve.removed, curve.by_confidence, "o-", ms=3, color=colour, label=method)
        axis.plot(curve.removed, curve.by_error, "--", lw=1, color=colour)
    axis.plot([], [], "--", lw=1, color="#57606a", label="the true error's order")
    axis.set_ylim(bottom=0)
    axis.grid(color="#eaeef2")
    axis.spines[["top", "right"]].set_visible(False)
    axis.legend(frameon=False, fontsize=8)
    return png(drawn)
