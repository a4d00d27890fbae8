"""Strip plots as SVG: a line for each method, a dot for each part, which leads to its section."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from statistics import median

from industnerf.report.html.markup import part_href

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


def strip_plot(
    rows: Mapping[str, Sequence[Dot]], label: str, *, log: bool = False, best: float | None = None
) -> str:
    """An SVG of `rows`, by their medians; a dashed line at `best`.  Empty if there is no dot."""
    rows = {name: dots for name, dots in rows.items() if dots}
    if not rows:
        return ""
    values = [dot.value for dots in rows.values() for dot in dots]
    scale = Scale.covering([*values, *([] if best is None else [best])], log=log)
    ordered = sorted(rows.items(), key=lambda row: (median(d.value for d in row[1]), row[0]))
    height = TOP + ROW_HEIGHT * len(rows)
    pieces = [_grid(scale, height, label, best)]
    pieces += [_strip(scale, TOP + ROW_HEIGHT * (i + 0.5), *row) for i, row in enumerate(ordered)]
    return (
        f"<svg class=plot viewBox='0 0 {WIDTH} {height + BOTTOM}' role=group "
        f"aria-label='{escape(label)}'>{''.join(pieces)}</svg>"
    )


def _grid(scale: Scale, height: int, label: str, best: float | None) -> str:
    svg_lines = "".join(
        f"<line class=grid x1={x} x2={x} y1={TOP} y2={height} />"
        f"<text class=tick x={x} y={height + 16} text-anchor=middle>{tick:.6g}</text>"
        for tick in scale.ticks()
        for x in [scale.position(tick)]
    )
    if best is not None:
        x = scale.position(best)
        svg_lines += f"<line class=zero x1={x} x2={x} y1={TOP} y2={height} />"
    middle = (LEFT + WIDTH - RIGHT) / 2
    return f"{svg_lines}<text x={middle} y={height + 36} text-anchor=middle>{escape(label)}</text>"


def _strip(scale: Scale, y: float, name: str, dots: Sequence[Dot]) -> str:
    """Dots in the order of their values, scattered up and down by their place in it."""
    ordered = sorted(dots, key=lambda dot: (dot.value, dot.part_id))
    dot_svgs = "".join(_dot(scale, y + 2.2 * (7 * i % 9 - 4), dot) for i, dot in enumerate(ordered))
    x = scale.position(median(dot.value for dot in dots))
    return (
        f"<text x={LEFT - 10} y={y + 4} text-anchor=end>{escape(name)}</text>{dot_svgs}"
        f"<line class=median x1={x} x2={x} y1={y - 12} y2={y + 12} />"
    )


def _dot(scale: Scale, y: float, dot: Dot) -> str:
    failed = " class=failed" if dot.failed else ""
    label = f"{dot.part_id}: {dot.value:.4g}" + (" (failed)" if dot.failed else "")
    return (
        f"<a tabindex=-1 href='{part_href(dot.part_id)}'>"
        f"<circle{failed} cx={scale.position(dot.value)} cy={y:.1f} r=3>"
        f"<title>{escape(label)}</title></circle></a>"
    )
