"""The points of a sweep as series over the first swept key: how costs grow, what a step changes."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from itertools import pairwise
from typing import Any

import numpy as np

from industnerf.report.statistics.significance import BOOTSTRAP_SEED, PairedChange, paired_change
from industnerf.report.sweeps.points import PointResult, SweepPoint
from industnerf.schema import ReportParams

COST_QUANTITIES = ("seconds", "peak_mb")


@dataclass(frozen=True)
class Series:
    """One method at one value of every other swept key; `x` are numbers, or else texts."""

    label: str
    x: list[Any]
    results: list[PointResult]

    @property
    def is_numeric(self) -> bool:
        return all(isinstance(x, int | float) and not isinstance(x, bool) for x in self.x)


@dataclass(frozen=True)
class PowerLaw:
    """y = factor * x**exponent; `error` is the standard error of the exponent."""

    exponent: float
    error: float
    factor: float
    points: int


def power_law(x: Sequence[int | float], y: Sequence[int | float]) -> PowerLaw | None:
    """The least-squares fit in logarithms.

    Points without a logarithm are left out. None if fewer than three remain, or all at one x.
    """
    points = np.array([pair for pair in zip(x, y, strict=True) if min(pair) > 0], float)
    if len(points) < 3 or np.ptp(points[:, 0]) == 0:
        return None
    u, v = np.log(points).T
    sum_of_squares = float(((u - u.mean()) ** 2).sum())
    exponent = float(((u - u.mean()) * (v - v.mean())).sum()) / sum_of_squares
    offset = float(v.mean() - exponent * u.mean())
    residual = float(((v - offset - exponent * u) ** 2).sum())
    error = float(np.sqrt(residual / (len(points) - 2) / sum_of_squares))
    return PowerLaw(exponent, error, float(np.exp(offset)), len(points))


@dataclass(frozen=True)
class Trend:
    """The growth of `quantity` in the series `label`."""

    label: str
    quantity: str
    law: PowerLaw


def make_series(points: list[SweepPoint], swept: list[str]) -> list[Series]:
    """A series for every method, split, and combination of the other swept keys."""
    by_label: dict[str, list[tuple[Any, PointResult]]] = {}
    has_several_splits = len({result.split for point in points for result in point.results}) > 1
    for point in points:
        others = [f"{key}={point.params.get(key)}" for key in swept[1:]]
        for result in point.results:
            split = [result.split] if has_several_splits else []
            label = " ".join([result.method, *split, *others])
            by_label.setdefault(label, []).append((point.axis_value(swept[0]), result))
    return [_ordered(label, pairs) for label, pairs in sorted(by_label.items())]


def _ordered(label: str, pairs: list[tuple[Any, PointResult]]) -> Series:
    ordered = Series(label, [x for x, _ in pairs], [result for _, result in pairs])
    if ordered.is_numeric:
        pairs = sorted(pairs, key=lambda pair: pair[0])
        return Series(label, [x for x, _ in pairs], [result for _, result in pairs])
    return Series(label, [str(x) for x in ordered.x], ordered.results)


def fit_trends(series_list: list[Series], key: str) -> list[Trend]:
    """The power laws of the costs of all series; none unless `key` is a size."""
    if key == "seed":  # which is no size
        return []
    fitted = []
    for series in series_list:
        for quantity in COST_QUANTITIES if series.is_numeric else ():
            known = [
                (x, getattr(r, quantity)) for x, r in zip(series.x, series.results, strict=True)
            ]
            pairs = [(x, y) for x, y in known if y is not None]
            law = power_law([x for x, _ in pairs], [y for _, y in pairs])
            if law is not None:
                fitted.append(Trend(series.label, quantity, law))
    return fitted


STEP_HEADERS = ["series", "from", "to", "EMD changes by", "ci_low", "ci_high", "parts", "better on"]


@dataclass(frozen=True)
class Step:
    """The change of a series from `before` to the next point, at `after`."""

    label: str
    before: Any
    after: Any
    change: PairedChange


def step_changes(series_list: list[Series], points: list[SweepPoint]) -> list[Step]:
    """Every step of every series whose points have parts in common."""
    families = {part: family for point in points for part, family in point.families.items()}
    settings = _report_params(points[0].params)
    return [
        Step(series.label, x, next_x, change)
        for series in series_list
        for (x, result), (next_x, next_result) in pairwise(
            zip(series.x, series.results, strict=True)
        )
        if (
            change := paired_change(
                result.emd_by_part, next_result.emd_by_part, families, settings, BOOTSTRAP_SEED
            )
        )
        is not None
    ]


def step_table(steps: list[Step]) -> list[list[str]]:
    """A header and a row per step; below 0 the later point is better."""
    return [STEP_HEADERS] + [
        [step.label, str(step.before), str(step.after), *_cells(step)] for step in steps
    ]


def _cells(step: Step) -> list[str]:
    change = step.change
    ends = (change.mean, change.low, change.high)
    values = ["" if value is None else f"{value:+.5f}" for value in ends]
    return [*values, str(change.parts), str(change.num_lower)]


def _report_params(params: Mapping[str, Any]) -> ReportParams:
    return ReportParams(
        **{field.name: params[f"report.{field.name}"] for field in fields(ReportParams)}
    )
