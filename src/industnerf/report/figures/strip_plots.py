"""Strip plots: a line for each method, a dot for each part.

What is here is where everything stands, in px; templates/macros.html.j2 writes the SVG.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import median

from industnerf.report.study import Study
from industnerf.report.tables.scores import AUSE, AUSE_RANDOM, EMD_EVEN, SPEARMAN, Scores

WIDTH, LEFT, RIGHT, ROW_HEIGHT, TOP, BOTTOM = 1100, 130, 30, 30, 8, 44  # px
TICKS = 8  # about so many


@dataclass(frozen=True)
class Dot:
    """One part."""

    part_id: str
    value: float
    failed: bool = False


@dataclass(frozen=True)
class Scale:
    """Where a value stands, from left to right."""

    low: float
    high: float
    log: bool

    @staticmethod
    def covering(values: Sequence[float], *, log: bool) -> "Scale":
        """A scale that holds all `values`, of which none is 0 or less if it is logarithmic."""
        low, high = min(values), max(values)
        if log:
            return Scale(low / 1.05, high * 1.05, log)
        margin = 0.03 * (high - low) or 0.5
        return Scale(low - margin, high + margin, log)

    def position(self, value: float) -> float:
        """The place of `value`, px."""
        low, high, position_value = (
            math.log(v) if self.log else v for v in (self.low, self.high, value)
        )
        return round(LEFT + (WIDTH - LEFT - RIGHT) * (position_value - low) / (high - low), 1)

    def ticks(self) -> list[float]:
        """Round values within the scale."""
        if self.log:
            steps = [m * 10.0**e for e in range(-6, 7) for m in (1, 2, 3, 5)]
        else:
            rough = (self.high - self.low) / TICKS
            power = 10.0 ** math.floor(math.log10(rough))
            step = next(m * power for m in (1, 2, 5, 10) if m * power >= rough)
            first = math.ceil(self.low / step)
            steps = [(first + i) * step for i in range(2 * TICKS)]
        return [tick for tick in steps if self.low <= tick <= self.high]


@dataclass(frozen=True)
class Mark:
    """A dot as it is drawn."""

    part_id: str
    x: float
    y: str
    failed: bool
    title: str  # shown when the pointer rests on it


@dataclass(frozen=True)
class Strip:
    """The line of one method."""

    name: str
    y: float
    median_x: float
    marks: list[Mark]


@dataclass(frozen=True)
class StripPlot:
    """A plot as it is drawn."""

    label: str
    ticks: list[tuple[float, str]]  # px, and the value
    best_x: float | None  # of the dashed line
    strips: list[Strip]
    bottom: int
    width: int = WIDTH
    left: int = LEFT
    top: int = TOP
    margin: int = BOTTOM
    middle: float = (LEFT + WIDTH - RIGHT) / 2


def strip_plot(
    rows: Mapping[str, Sequence[Dot]], label: str, *, log: bool = False, best: float | None = None
) -> StripPlot | None:
    """The plot of `rows`, ordered by their medians; a dashed line at `best`. None without a dot."""
    rows = {name: dots for name, dots in rows.items() if dots}
    if not rows:
        return None
    values = [dot.value for dots in rows.values() for dot in dots]
    scale = Scale.covering([*values, *([] if best is None else [best])], log=log)
    ordered = sorted(rows.items(), key=lambda row: (median(d.value for d in row[1]), row[0]))
    return StripPlot(
        label,
        [(scale.position(tick), f"{tick:.6g}") for tick in scale.ticks()],
        None if best is None else scale.position(best),
        [_strip(scale, TOP + ROW_HEIGHT * (i + 0.5), *row) for i, row in enumerate(ordered)],
        TOP + ROW_HEIGHT * len(rows),
    )


def _strip(scale: Scale, y: float, name: str, dots: Sequence[Dot]) -> Strip:
    """Dots in the order of their values, scattered up and down by their place in it."""
    ordered = sorted(dots, key=lambda dot: (dot.value, dot.part_id))
    marks = [
        Mark(
            dot.part_id,
            scale.position(dot.value),
            f"{y + 2.2 * (7 * i % 9 - 4):.1f}",
            dot.failed,
            f"{dot.part_id}: {dot.value:.4g}" + (" (failed)" if dot.failed else ""),
        )
        for i, dot in enumerate(ordered)
    ]
    return Strip(name, y, scale.position(median(dot.value for dot in dots)), marks)


def distribution_plot(study: Study, scores: Scores) -> StripPlot | None:
    """EMD (even) over the floor, every part of every method; None without a score."""
    rows = {
        method: [
            Dot(part, score.value / score.floor, score.status != "ok")
            for part in study.parts
            if (score := scores.get(part, method, EMD_EVEN)) and score.value > 0 < score.floor
        ]
        for method in study.methods
    }
    return strip_plot(rows, "EMD (even) / floor", log=True, best=1.0)


def calibration_plots(study: Study, scores: Scores) -> list[StripPlot]:
    """Rank correlation and AUSE of every part that has them."""
    correlations: dict[str, list[Dot]] = {}
    areas: dict[str, list[Dot]] = {}
    for method in study.methods:
        correlations[method], areas[method] = [], []
        for part in study.parts:
            correlation = scores.get(part, method, SPEARMAN)
            area, random_area = (scores.get(part, method, key) for key in (AUSE, AUSE_RANDOM))
            if correlation:
                correlations[method].append(Dot(part, correlation.value))
            if area and random_area and random_area.value > 0:
                areas[method].append(Dot(part, area.value / random_area.value))
    plots = (
        strip_plot(correlations, "rank correlation of confidence and error", best=-1.0),
        strip_plot(areas, "AUSE / AUSE of a random order", best=0.0),
    )
    return [plot for plot in plots if plot]
