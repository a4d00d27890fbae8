"""The points of a sweep as lines over the first thing that is swept, and how their costs grow."""

from dataclasses import dataclass
from typing import Any

from industnerf.report.sweep_points import Point, Result
from industnerf.report.trend import PowerLaw, power_law

COSTS = ("seconds", "peak_mb")


@dataclass(frozen=True)
class Series:
    """One method, at one value of whatever else is swept; `x` are numbers, or else texts."""

    label: str
    x: list[Any]
    results: list[Result]

    @property
    def numeric(self) -> bool:
        return all(isinstance(x, int | float) and not isinstance(x, bool) for x in self.x)


@dataclass(frozen=True)
class Trend:
    """How `quantity` of the series `label` grows."""

    label: str
    quantity: str
    law: PowerLaw


def series(points: list[Point], swept: list[str]) -> list[Series]:
    """A series a method and split, and a value of each swept key but the first."""
    lines: dict[str, list[tuple[Any, Result]]] = {}
    several = len({result.split for point in points for result in point.results}) > 1
    for point in points:
        others = [f"{key}={point.params.get(key)}" for key in swept[1:]]
        for result in point.results:
            split = [result.split] if several else []
            label = " ".join([result.method, *split, *others])
            lines.setdefault(label, []).append((point.at(swept[0]), result))
    return [_ordered(label, pairs) for label, pairs in sorted(lines.items())]


def _ordered(label: str, pairs: list[tuple[Any, Result]]) -> Series:
    found = Series(label, [x for x, _ in pairs], [result for _, result in pairs])
    if found.numeric:
        pairs = sorted(pairs, key=lambda pair: pair[0])
        return Series(label, [x for x, _ in pairs], [result for _, result in pairs])
    return Series(label, [str(x) for x in found.x], found.results)


def trends(lines: list[Series], key: str) -> list[Trend]:
    """The power law of every cost of every series over numbers of `key` that has one."""
    if key == "seed":  # which is no size
        return []
    found = []
    for line in lines:
        for quantity in COSTS if line.numeric else ():
            known = [(x, getattr(r, quantity)) for x, r in zip(line.x, line.results, strict=True)]
            pairs = [(x, y) for x, y in known if y is not None]
            law = power_law([x for x, _ in pairs], [y for _, y in pairs])
            if law is not None:
                found.append(Trend(line.label, quantity, law))
    return found
