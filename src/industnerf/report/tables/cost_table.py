"""What each method costs, dev parts included: a reconstruction, and learning before it."""

from collections.abc import Sequence
from dataclasses import dataclass
from statistics import fmean

from industnerf.report.study import Study
from industnerf.report.tables.costs import CostRow
from industnerf.report.tables.formats import format_fixed, markdown_table

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
class MethodCost:
    """One method: means over parts or nets, of memory the most; None where nothing is known."""

    method: str
    seconds: float | None
    extra_seconds: float | None  # renderings of the held-out views
    peak_mb: float | None
    nets: int
    net_minutes: float | None
    net_peak_mb: float | None
    num_parameters: int  # learned
    steps: int
    scoring_seconds: float | None


def method_costs(study: Study, costs: Sequence[CostRow]) -> list[MethodCost]:
    """A line a method, the quickest first, those of unknown cost last."""
    rows = [_method_cost(study, name, costs) for name in study.methods]
    return sorted(rows, key=lambda row: (row.seconds is None, row.seconds))


def _method_cost(study: Study, method: str, costs: Sequence[CostRow]) -> MethodCost:
    reconstruct_costs, train_costs, evaluate_costs = (
        [row.cost for row in costs if (row.stage, row.method) == (stage, method)]
        for stage in ("reconstruct", "train", "evaluate")
    )
    num_parameters, steps = study.parameters_and_steps[method]
    return MethodCost(
        method,
        _mean([cost.seconds for cost in reconstruct_costs]),
        _mean([cost.extra_seconds for cost in reconstruct_costs]),
        max((cost.peak_mb for cost in reconstruct_costs), default=None),
        len(train_costs),
        _mean([cost.seconds / 60 for cost in train_costs]),
        max((cost.peak_mb for cost in train_costs), default=None),
        num_parameters,
        steps,
        _mean([cost.seconds for cost in evaluate_costs]),
    )


def _mean(values: list[float]) -> float | None:
    return fmean(values) if values else None


def format_row(row: MethodCost) -> list[str]:
    """`line` as people read it, one text for each of COLUMNS."""
    return [
        row.method,
        format_fixed(row.seconds, 2),
        format_fixed(row.extra_seconds, 2),
        format_fixed(row.peak_mb, 0),
        str(row.nets or ""),
        format_fixed(row.net_minutes, 1),
        format_fixed(row.net_peak_mb, 0),
        str(row.num_parameters or ""),
        str(row.steps or ""),
        format_fixed(row.scoring_seconds, 2),
    ]


def cost_table_md(rows: Sequence[MethodCost]) -> str:
    """`cost.md`: the means of cost.csv."""
    return markdown_table(COLUMNS, map(format_row, rows))
