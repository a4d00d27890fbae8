"""What each method costs, dev parts included: a reconstruction, and learning before it."""

from collections.abc import Sequence
from dataclasses import dataclass
from statistics import fmean

from industnerf.report.costs import CostRow
from industnerf.report.formats import markdown, short
from industnerf.report.gather import Study

COLUMNS = (
    "method",
    "s a part",
    "beside it, s",
    "highest peak, MB",
    "nets",
    "minutes a net",
    "highest peak of learning, MB",
    "numbers",
    "steps",
    "scoring, s a part",
)


@dataclass(frozen=True)
class Spending:
    """One method: means over parts or nets, of memory the most; None where nothing is known."""

    method: str
    seconds: float | None
    aside_s: float | None  # renderings of the held-out views
    peak_mb: float | None
    nets: int
    net_minutes: float | None
    net_peak_mb: float | None
    numbers: int  # learned
    steps: int
    scoring_s: float | None


def spending(study: Study, costs: Sequence[CostRow]) -> list[Spending]:
    """A line a method, the quickest first, those of unknown cost last."""
    lines = [_line(study, name, costs) for name in study.methods]
    return sorted(lines, key=lambda line: (line.seconds is None, line.seconds))


def _line(study: Study, method: str, costs: Sequence[CostRow]) -> Spending:
    made, learned, scored = (
        [row.cost for row in costs if (row.stage, row.method) == (stage, method)]
        for stage in ("reconstruct", "train", "evaluate")
    )
    numbers, steps = study.training[method]
    return Spending(
        method,
        _mean([cost.seconds for cost in made]),
        _mean([cost.aside_s for cost in made]),
        max((cost.peak_mb for cost in made), default=None),
        len(learned),
        _mean([cost.seconds / 60 for cost in learned]),
        max((cost.peak_mb for cost in learned), default=None),
        numbers,
        steps,
        _mean([cost.seconds for cost in scored]),
    )


def _mean(values: list[float]) -> float | None:
    return fmean(values) if values else None


def cells(line: Spending) -> list[str]:
    """`line` as people read it, one text for each of COLUMNS."""
    return [
        line.method,
        short(line.seconds, 2),
        short(line.aside_s, 2),
        short(line.peak_mb, 0),
        str(line.nets or ""),
        short(line.net_minutes, 1),
        short(line.net_peak_mb, 0),
        str(line.numbers or ""),
        str(line.steps or ""),
        short(line.scoring_s, 2),
    ]


def spending_md(lines: Sequence[Spending]) -> str:
    """`cost.md`: the means of cost.csv."""
    return markdown(COLUMNS, map(cells, lines))
