"""What every step of a sweep changes: the same parts at one point and at the next."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from itertools import pairwise
from typing import Any

from industnerf.report.statistics import SEED, Change, paired_change
from industnerf.report.sweep_points import Point
from industnerf.report.sweep_series import Series
from industnerf.schema import ReportParams

HEAD = ["series", "from", "to", "EMD changes by", "ci_low", "ci_high", "parts", "better on"]


@dataclass(frozen=True)
class Step:
    """One series from the point at `before` to the next, at `after`."""

    label: str
    before: Any
    after: Any
    change: Change


def steps(lines: list[Series], points: list[Point]) -> list[Step]:
    """Every step of every series; none where neighbours have no part in common."""
    families = {part: family for point in points for part, family in point.families.items()}
    ways = _ways(points[0].params)
    return [
        Step(line.label, x, y, change)
        for line in lines
        for (x, one), (y, other) in pairwise(zip(line.x, line.results, strict=True))
        if (change := paired_change(one.emds, other.emds, families, ways, SEED)) is not None
    ]


def table(found: list[Step]) -> list[list[str]]:
    """A line a step; below 0 the later point is better."""
    return [HEAD] + [
        [step.label, str(step.before), str(step.after), *_cells(step)] for step in found
    ]


def _cells(step: Step) -> list[str]:
    change = step.change
    values = [f"{value:+.5f}" for value in (change.mean, change.low, change.high)]
    return [*values, str(change.parts), str(change.lower)]


def _ways(params: Mapping[str, Any]) -> ReportParams:
    return ReportParams(
        **{field.name: params[f"report.{field.name}"] for field in fields(ReportParams)}
    )
