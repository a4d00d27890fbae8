"""The points of a sweep as lines over the first thing that is swept, and how their costs grow."""

from dataclasses import dataclass
from typing import Any

from industnerf.report.statistics.power_law import PowerLaw, power_law
from industnerf.report.sweeps.points import PointResult, SweepPoint

COST_QUANTITIES = ("seconds", "peak_mb")


@dataclass(frozen=True)
class Series:
    """One method, at one value of whatever else is swept; `x` are numbers, or else texts."""

    label: str
    x: list[Any]
    results: list[PointResult]

    @property
    def is_numeric(self) -> bool:
        return all(isinstance(x, int | float) and not isinstance(x, bool) for x in self.x)


@dataclass(frozen=True)
class Trend:
    """How `quantity` of the series `label` grows."""

    label: str
    quantity: str
    law: PowerLaw


def make_series(points: list[SweepPoint], swept: list[str]) -> list[Series]:
    """A series a method and split, and a value of each swept key but the first."""
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
    """The power law of every cost of every series over numbers of `key` that has one."""
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
