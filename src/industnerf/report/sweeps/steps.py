"""What every step of a sweep changes: the same parts at one point and at the next."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from itertools import pairwise
from typing import Any

from industnerf.report.statistics.significance import BOOTSTRAP_SEED, PairedChange, paired_change
from industnerf.report.sweeps.points import SweepPoint
from industnerf.report.sweeps.series import Series
from industnerf.schema import ReportParams

HEADERS = ["series", "from", "to", "EMD changes by", "ci_low", "ci_high", "parts", "better on"]


@dataclass(frozen=True)
class Step:
    """One series from the point at `before` to the next, at `after`."""

    label: str
    before: Any
    after: Any
    change: PairedChange


def step_changes(series_list: list[Series], points: list[SweepPoint]) -> list[Step]:
    """Every step of every series; none where neighbors have no part in common."""
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
    """A line a step; below 0 the later point is better."""
    return [HEADERS] + [
        [step.label, str(step.before), str(step.after), *_cells(step)] for step in steps
    ]


def _cells(step: Step) -> list[str]:
    change = step.change
    values = [f"{value:+.5f}" for value in (change.mean, change.low, change.high)]
    return [*values, str(change.parts), str(change.num_lower)]


def _report_params(params: Mapping[str, Any]) -> ReportParams:
    return ReportParams(
        **{field.name: params[f"report.{field.name}"] for field in fields(ReportParams)}
    )
